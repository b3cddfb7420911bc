// SPDX-License-Identifier: Apache-2.0
/* mesh.h: a finished mesh and the report about it.
 *
 * Everything here belongs to the tet_mesh and goes with tet_mesh_free. */
#ifndef TET_MESH_H
#define TET_MESH_H

#include <stddef.h>
#include <stdint.h>
#include <tet/context.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TET_NONE UINT32_MAX

typedef enum tet_origin {
  TET_ORIGIN_INPUT = 0,
  TET_ORIGIN_SEGMENT = 1, /* a Steiner point on a segment */
  TET_ORIGIN_FACET = 2,   /* on a facet */
  TET_ORIGIN_VOLUME = 3
} tet_origin;

enum { TET_MAX_STAGES = 9, TET_HISTOGRAM_BINS = 16 };

typedef struct tet_stage_report {
  const char *name;
  double seconds;      /* wall */
  double cpu_seconds;  /* of the meshing thread */
  uint64_t peak_bytes; /* the context's peak when the stage ended */
  uint64_t vertices;   /* after the stage */
  uint64_t tetrahedra;
} tet_stage_report;

/* bins[i] counts values in [edges[i], edges[i+1]); the last edge is infinite
 * where the measure is unbounded. */
typedef struct tet_histogram {
  uint32_t n_bins;
  double edges[TET_HISTOGRAM_BINS + 1];
  uint64_t bins[TET_HISTOGRAM_BINS];
  double min, max;
} tet_histogram;

typedef struct tet_quality {
  tet_histogram radius_edge;  /* circumradius / shortest edge (3.2.1) */
  tet_histogram dihedral_min; /* smallest of each tetrahedron, degrees */
  tet_histogram dihedral_max;
  tet_histogram aspect;       /* longest edge / shortest height */
  double volume;
} tet_quality;

/* What is claimed of the mesh. */
typedef struct tet_promise {
  int delaunay;              /* every face locally Delaunay */
  int constrained_delaunay;  /* every face off the subfaces locally Delaunay */
  int gabriel;               /* subfaces and subsegments Gabriel, creases and merged sides aside */
  int covered;               /* every face of the mesh's boundary is a subface */
  int convex;                /* the mesh fills the convex hull of its vertices */
  double radius_edge;        /* bound, the listed exceptions aside; 0: none */
  int radius_edge_proven;    /* the bound is at least sqrt(2), as which 1.414 counts: away from sharp segments it
                                is reached (Theorem 3.3.14); below, that is but tried */
  double max_volume;         /* bound, the listed exceptions aside; 0: none */
  double min_dihedral;       /* degrees, the listed slivers aside; 0: none */
  int region_volumes;        /* the regions' own bounds hold, the exceptions aside */
  double planarity;          /* largest deviation of a polygon from its plane */
  double merge_angle;        /* degrees: sides of facets of one marker within it of flat are creases; 0: none */
  double merged_angle;       /* the largest angle off flat among them, */
  double merged_distance;    /* and the largest distance of a triangle's vertex there from the other one's plane */
} tet_promise;

/* What `audit` found by exact arithmetic on the arrays below: counts of faults. */
typedef struct tet_audit {
  uint64_t bad_indices;         /* out of range; if any, nothing else was looked at */
  uint64_t flat_or_inverted;
  uint64_t adjacency;           /* faces with more than two tetrahedra, one side */
  uint64_t not_delaunay;        /* interior faces, subfaces included */
  uint64_t not_constrained_delaunay; /* interior faces that are no subfaces */
  uint64_t subfaces_missing;    /* listed, but no face of the mesh */
  uint64_t subsegments_missing;
  uint64_t uncovered;           /* boundary faces that are no subfaces */
  uint64_t reflex;              /* boundary edges at which the mesh is not convex */
  uint64_t broken_segments;     /* whose subsegments are not one open chain */
  uint64_t facet_slivers;       /* tetrahedra with two subfaces that meet inside a facet */
  uint64_t subfaces_encroached; /* not Gabriel */
  uint64_t subsegments_encroached;
  uint64_t over_radius_edge;    /* not listed as exceptions, over the bound */
  uint64_t over_volume;
  uint64_t under_dihedral;      /* not listed as slivers, under the bound */
  uint64_t region_leaks;        /* faces off subfaces between two regions */
  /* against the PLS; of the stage delaunay, 0 */
  uint64_t wrong_regions;       /* that are not one part, or not where their seeds are; hole seeds in the mesh */
  uint64_t wrong_markers;       /* subfaces without their facet's marker */
  uint64_t lost_vertices;       /* moved, or inside and no vertex of the mesh */
  uint64_t bad_segments;        /* loose segments that subsegments do not cover */
  uint64_t bad_facets;          /* that their subfaces do not cover, or not once; parts outside the mesh aside */
  uint64_t folded_subfaces;     /* turned over in their facet, or out of its plane */
  int passed;                   /* everything promised holds */
  uint32_t facet;               /* the first of bad_facets, or TET_NONE */
} tet_audit;

/* Candidates that refinement found and did not insert, by reason. */
typedef struct tet_rejections {
  uint64_t protected_ball; /* the accepting rule (4.1.4) */
  uint64_t outside;        /* walked out of the domain */
  uint64_t lost_subface;   /* the cavity would lose a constraint */
  uint64_t too_short;      /* a subsegment of a few ulps, or a subface as narrow as that */
  uint64_t given_up;       /* far from what asks for it, where too many such were searched for in vain */
} tet_rejections;

typedef struct tet_counts {
  uint64_t input_vertices, duplicate_vertices, unused_vertices;
  uint64_t facets, repeated_facets, segments;
  uint64_t missing_segments, segment_steiner_points;
  uint64_t break_points, degeneracies_left; /* where they were asked for (5.5); pairs of facet triangles that are
                                               cocircular still, when facets were recovered */
  uint64_t missing_subfaces, cavities;
  uint64_t rounding_flips, rounding_moves;
  uint64_t squeezed_points; /* in the volume of the CDT, for faces that lay on facets as near as matters */
  uint64_t refine_segment_points, refine_facet_points, refine_volume_points;
  uint64_t first_slivers, sliver_points; /* before their removal; of the points above, those that it inserted */
  uint64_t sliver_budget; /* as many at most, about: where sliver_points reached it, slivers were given up */
  uint64_t thin_points, thin_budget; /* of the points above, those in facets at dihedral angles of a few degrees; and
                                        where they reached that, nothing there was split any more */
  uint64_t outside_tetrahedra;
} tet_counts;

/* How exceptions were traced to the sharp segments to blame (thesis 4.2.2). alpha_2 H(p) is the
 * radius of the protecting ball of a vertex p of that segment; a tetrahedron's distance from its
 * subsegment is measured in the larger such radius of the ends over sin theta, theta the segment's least sharp
 * angle. One within TET_TRACE_REACH is traced; one beyond is only listed with its subsegment. */
enum { TET_TRACE_REACH = 5 };

typedef struct tet_trace {
  uint64_t traced;   /* exceptions within that reach */
  uint64_t slivers;  /* slivers within it */
  uint64_t followed; /* exceptions whose subsegment was found through their rejected candidates; the
                        others have the nearest one */
  uint64_t within;   /* circumcentre within sqrt(2) alpha_2 H(p) of an end p of that subsegment (Theorem 4.2.3) */
  double farthest;   /* largest distance of an exception */
} tet_trace;

/* Of Voronoi cells, where they were asked for. */
typedef struct tet_voronoi_report {
  int made;
  uint64_t negative_factors; /* edge factors below 0 by more than rounding */
  double worst_factor;       /* the lowest of them, else 0 */
  uint32_t worst_edge[2];    /* its vertices */
  uint32_t worst_region;
} tet_voronoi_report;

typedef struct tet_report {
  uint32_t n_stages;
  tet_stage_report stages[TET_MAX_STAGES];
  tet_counts counts;
  tet_quality quality;
  tet_promise promised;
  tet_audit audit;
  tet_rejections rejected;
  tet_trace trace;
  tet_voronoi_report voronoi;
  uint64_t peak_bytes;
} tet_report;

typedef struct tet_mesh {
  tet_ctx *ctx; /* that accounts for the arrays */

  uint32_t n_points;
  uint32_t n_input_points;  /* rows 0 .. n_input_points-1 are the input's, in order */
  double *points;           /* [n_points][3]; input rows keep their bits */
  uint32_t n_attributes;
  double *point_attributes; /* [n_points][n_attributes]; interpolated on new ones */
  int32_t *point_markers;   /* [n_points] */
  uint8_t *point_origin;    /* [n_points] tet_origin */
  uint32_t *point_same_as;  /* [n_input_points] survivor of a merged duplicate, else itself */

  uint32_t n_tetrahedra;
  uint32_t *tetrahedra;         /* [n][4], orient3d > 0 */
  uint32_t *tetrahedron_regions; /* [n] row of the region table */
  uint32_t *neighbours;         /* [n][4] opposite vertex i, or TET_NONE; NULL unless asked for */

  uint32_t n_input_facets;   /* of the PLS; 0 of the stage delaunay */
  uint32_t *facet_same_as;   /* [n] lowest of the coplanar facets merged with it, or of those that it repeats, whose
                                number its subfaces have; else itself */
  uint32_t n_subfaces;
  uint32_t *subfaces;        /* [n][3] */
  uint32_t *subface_facets;  /* [n] input facet; of a system without facets, of its hull */
  int32_t *subface_markers;  /* [n] */

  uint32_t n_subsegments;
  uint32_t *subsegments;          /* [n][2] */
  uint32_t *subsegment_segments;  /* [n] segment number */
  int32_t *subsegment_markers;    /* [n] */

  uint32_t n_regions;
  int32_t *region_markers;    /* [n]; seeds keep theirs, others are numbered on */
  double *region_attributes;  /* [n] */
  double *region_max_volumes; /* [n]; 0: none */

  uint32_t n_exceptions;            /* tetrahedra that break the promised bound */
  uint32_t *exception_tetrahedra;   /* [n] */
  double *exception_radius_edge;    /* [n] */
  uint32_t *exception_segments;     /* [n] subsegment row of the sharp segment to blame, or TET_NONE */

  uint32_t n_slivers;               /* tetrahedra with a dihedral angle below the promised bound */
  uint32_t *sliver_tetrahedra;      /* [n] */
  double *sliver_cosines;           /* [n] of the smallest dihedral angle */
  uint32_t *sliver_segments;        /* [n] as exception_segments */

  /* Voronoi cells cut to the domain and its regions; NULL (and 0 rows) unless asked for.
   * For c at the vertices and a flux function g, (1.3) of the thesis reads
   * |K| (c_K - c_K') / dt + sum over the edges KL of factor g(c_K, c_L) = 0. */
  uint32_t n_cells;
  uint32_t *cell_vertices; /* [n] ascending: the vertex K that the cell is of, */
  uint32_t *cell_regions;  /* [n] then ascending: the region that it is in */
  double *cell_volumes;    /* [n] |K| */
  uint32_t n_edges;
  uint32_t *edge_vertices; /* [n][2] K < L, ascending */
  uint32_t *edge_regions;  /* [n] ascending for each edge: regions around it */
  double *edge_factors;    /* [n] |sigma_KL| / |x_K - x_L| in that region; signed */
  double *subface_shares;  /* [n_subfaces][3] areas of the cells' cuts by a subface, of its vertices; signed */

  /* The cells as polyhedra, closed by polygons on the borders of regions; NULL unless asked for.
   * Face m, for m < n_edges, is that of row m of the edges (its first, where a region touches
   * itself at the edge); further ones of such edges follow, then those on borders. */
  uint32_t n_voronoi_points;
  double *voronoi_points;         /* [n][3]; the first n_tetrahedra are the tetrahedra's circumcentres */
  uint32_t n_voronoi_faces;
  uint32_t *voronoi_face_start;   /* [n + 1] CSR: face to its corners, */
  uint32_t *voronoi_face_points;  /* counterclockwise seen from the second cell: rows of voronoi_points */
  uint32_t *voronoi_face_cells;   /* [n][2] rows of the cells on both sides; the second TET_NONE: outside */

  tet_report report;
} tet_mesh;

/* Frees a mesh and its arrays; NULL is fine. */
void tet_mesh_free(tet_mesh *mesh);

#ifdef __cplusplus
}
#endif
#endif
