// SPDX-License-Identifier: Apache-2.0
/* engine.h: from a PLS to a mesh.
 *
 *   tet_ctx *ctx;  tet_mesh *mesh;  tet_options options;
 *   tet_ctx_create(NULL, &ctx);
 *   tet_options_default(&options);
 *   if (tet_mesh_pls(ctx, &pls, &options, &mesh) != TET_OK)
 *     puts(tet_ctx_error(ctx)->message);
 *   tet_mesh_free(mesh);  tet_ctx_free(ctx);
 */
#ifndef TET_ENGINE_H
#define TET_ENGINE_H

#include <tet/mesh.h>
#include <tet/pls.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tet_stage {
  TET_STAGE_DELAUNAY = 0, /* Delaunay tetrahedralization of the points alone */
  TET_STAGE_CDT = 1,      /* constrained Delaunay tetrahedralization of the PLS */
  TET_STAGE_REFINE = 2    /* Delaunay refinement of the CDT (chapters 3 and 4) */
} tet_stage;

typedef enum tet_point_order {
  TET_ORDER_INPUT_FIRST = 0, /* input vertices keep their rows */
  TET_ORDER_HILBERT = 1      /* all vertices along a Hilbert curve */
} tet_point_order;

/* Which of the tetrahedra over the radius-edge bound is split next (3.3.5, Table 3.2; 3.3.6). Lengths
 * and ratios whose squares differ by less than a 32nd are alike, the newest first. */
typedef enum tet_insertion {
  TET_INSERT_O2_O1 = 0, /* of the shortest edge, by quarters of powers of two of its square; of those, as O1 */
  TET_INSERT_O1 = 1, /* of the largest radius-edge ratio */
  TET_INSERT_O2 = 2, /* of the shortest edge */
  TET_INSERT_O3 = 3, /* of the smallest circumradius */
  TET_INSERT_O4 = 4, /* of the largest circumradius */
  TET_INSERT_O5 = 5, /* at random */
  TET_INSERT_RELATIVELY_SHORT = 6 /* in rounds (DELAUNAYREFINE2, Fig. 3.18): all whose shortest edge was there
                                     when the round began, edge after edge; what came by that waits for the next */
} tet_insertion;

typedef enum tet_voronoi {
  TET_VORONOI_NONE = 0,
  TET_VORONOI_FACTORS = 1, /* cell volumes, edge factors, shares of subfaces */
  TET_VORONOI_DIAGRAM = 2  /* these, and the cells as polyhedra */
} tet_voronoi;

enum { TET_MAX_THREADS = 31, TET_MOST_DIHEDRAL = 30, TET_MOST_MERGE_ANGLE = 45 };

typedef struct tet_options {
  tet_stage stage;
  double radius_edge;          /* bound rho_0; >= 1, below sqrt(2) without a guarantee; default 2.0 */
  double max_volume;           /* of every tetrahedron; 0: none */
  double min_dihedral;         /* degrees, up to TET_MOST_DIHEDRAL: tetrahedra with a smaller dihedral angle are
                                  slivers, which refinement removes (3.4.2); 0: none are; default 5 */
  tet_insertion order;         /* of insertion; default O2_O1 */
  int keep_hull;               /* keep the convex hull: outside and holes stay (2.4.2); not with REFINE */
  double planarity_tolerance;  /* absolute; 0: 1e-5 of the box's diagonal */
  double merge_angle;          /* degrees, up to TET_MOST_MERGE_ANGLE: facets of one marker that meet within it of
                                  flat, at a side that only they have, are one facet but for exactness: the side
                                  is a crease, like a diagonal of a polygon out of plane. It is no sharp segment
                                  and not promised Gabriel; the mesh holds it, and splits it where it must to be a
                                  CDT. 0: only exactly coplanar ones are one, without a side; default */
  int break_points;            /* LOCALDEGENERACYREMOVAL (5.5): points are added on facets and segments until no two
                                  neighbouring triangles of a facet are cocircular; else such ties are broken by
                                  symbolic perturbation alone. Not with DELAUNAY */
  int neighbours;              /* deliver the neighbours array */
  tet_voronoi voronoi;         /* cells cut to the facets; not with DELAUNAY or keep_hull, whose hull has none */
  tet_point_order point_order; /* with HILBERT, point_same_as gives each input vertex's row */
  uint64_t seed;               /* of the insertion order; the result does not depend on it */
  uint32_t threads;            /* that the run may use, 1 to TET_MAX_THREADS; default 1. The result does not
                                  depend on it. Used for the Delaunay stage of many points so far */
} tet_options;

void tet_options_default(tet_options *options);

/* Meshes `pls`. Without facets there are Delaunay tetrahedra of its points, or, with TET_STAGE_REFINE, the
 * refined mesh of their convex hull, whose faces are its facets, those in one plane but for the last digits of points
 * together (report.promised.planarity says how far off). On success *ret_mesh is the caller's, to be freed before the
 * context; on failure it is untouched and tet_ctx_error(ctx) tells why. Cost:
 * about n log n in the output's size. Errors: every tet_status. */
tet_status tet_mesh_pls(tet_ctx *ctx, const tet_pls *pls, const tet_options *options, tet_mesh **ret_mesh);

#ifdef __cplusplus
}
#endif
#endif
