// SPDX-License-Identifier: Apache-2.0
/* shares.h: what one tetrahedron adds to the Voronoi faces of its edges.
 *
 * Inside a tetrahedron the Voronoi face of edge ij is the quadrilateral between the edge's
 * midpoint, the circumcentres of the two triangles at ij, and that of the tetrahedron. Its
 * area has a sign: a part that lies beyond a face of the tetrahedron is negative, and the
 * neighbour there has the same part positive. So the sums over all tetrahedra are right
 * though circumcentres lie outside of them, and at the boundary they are the Voronoi faces
 * cut to the domain where the boundary is Gabriel (thesis 1.2.1). Divided by |ij|:
 *
 *   s_ij = 1/4 sum over the two triangles ijk at ij of cot(angle at k) h_ijk
 *
 * with h the height of the tetrahedron's circumcentre over the triangle's plane, positive on
 * the tetrahedron's side. Two sums follow, to rounding for every tetrahedron:
 *
 *   1/3 sum over its edges of |ij|^2 s_ij = its volume,
 *   sum over j of s_ij (x_j - x_i) + sum over the triangles at i of (share of i) n = 0;
 *
 * the first makes cell volumes add up, the second makes linear functions exact. */
#ifndef TET_DUAL_SHARES_H
#define TET_DUAL_SHARES_H

#include <stdint.h>

/* Edge e of a tetrahedron joins vertices tet_edge[e][0] and [1]; [2] and [3] are the others. */
extern const uint8_t tet_edge[6][4];

typedef struct tet_shares {
  double edge[6];   /* s_ij, a length */
  double bound;     /* above the rounding error of each */
  double centre[3]; /* circumcentre, relative to vertex 0 */
} tet_shares;

/* The shares of the tetrahedron v[0..3] of `points`, which must be positive; returns 0 if it
 * is not, and *ret is untouched. Each is right to a few units in the last place of the larger
 * of its two parts: where doubles would lose more than a few digits, as in slivers, the
 * numerators and denominators are exact. Cost: 50 ns, in exact arithmetic several us. */
int tet_shares_of(const double *points, const uint32_t v[4], tet_shares *ret);

/* The shares of the corners a, b, c of a triangle in its area, cut by the bisectors of its
 * sides: signed, and summing to the area. ret_centre (or NULL): its circumcentre. */
void tet_corner_shares(const double a[3], const double b[3], const double c[3], double ret_shares[3],
                       double ret_centre[3]);

#endif
