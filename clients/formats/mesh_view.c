// SPDX-License-Identifier: Apache-2.0
/* mesh_view.c: the mesh arrays as typed pointers, checked, and the quality measures
 * that files carry. The measures are for viewers: no decision rests on them. */
#include "clients/formats/mesh_view.h"

#include <math.h>
#include <string.h>

static bool indices_below(const uint32_t *v, uint64_t n, uint64_t limit, bool or_none) {
    for (uint64_t i = 0; i < n; i++) {
        if (v[i] >= limit && !(or_none && v[i] == UINT32_MAX)) {
            return false;
        }
    }
    return true;
}

static bool starts_fit(const uint32_t *start, uint64_t rows, uint64_t entries) {
    if (rows == 0 || start[0] != 0 || start[rows - 1] != entries) {
        return false;
    }
    for (uint64_t i = 1; i < rows; i++) {
        if (start[i] < start[i - 1]) {
            return false;
        }
    }
    return true;
}

// False: a part is missing, or does not fit.
static bool view_dual(const tp_arrays *set, tf_mesh *m) {
    uint64_t n_starts = 0, n_corners = 0;
    m->cell_vertices = tp_arrays_data(set, "cell_vertices", &m->n_cells);
    m->cell_regions = tp_arrays_data(set, "cell_regions", NULL);
    m->cell_volumes = tp_arrays_data(set, "cell_volumes", NULL);
    m->edge_vertices = tp_arrays_data(set, "edge_vertices", &m->n_edges);
    m->edge_regions = tp_arrays_data(set, "edge_regions", NULL);
    m->edge_factors = tp_arrays_data(set, "edge_factors", NULL);
    m->subface_shares = tp_arrays_data(set, "subface_shares", NULL);
    m->voronoi_points = tp_arrays_data(set, "voronoi_points", &m->n_voronoi_points);
    m->voronoi_face_start = tp_arrays_data(set, "voronoi_face_start", &n_starts);
    m->voronoi_face_points = tp_arrays_data(set, "voronoi_face_points", &n_corners);
    m->voronoi_face_cells = tp_arrays_data(set, "voronoi_face_cells", &m->n_voronoi_faces);
    const bool factors = m->edge_factors != NULL, diagram = m->voronoi_face_start != NULL;
    if ((m->cell_volumes != NULL) != factors || (m->edge_regions != NULL) != factors ||
        (m->cell_regions != NULL) != factors || (m->subface_shares != NULL) != factors ||
        (m->voronoi_points != NULL) != diagram || (m->voronoi_face_points != NULL) != diagram ||
        (m->voronoi_face_cells != NULL) != diagram || (diagram && !factors)) {
        return false;
    }
    return (!factors || (m->region_markers != NULL &&
                         indices_below(m->cell_vertices, m->n_cells, m->n_points, false) &&
                         indices_below(m->cell_regions, m->n_cells, m->n_regions, false) &&
                         indices_below(m->edge_vertices, 2 * m->n_edges, m->n_points, false) &&
                         indices_below(m->edge_regions, m->n_edges, m->n_regions, false))) &&
           (!diagram ||
            (n_starts == m->n_voronoi_faces + 1 &&
             starts_fit(m->voronoi_face_start, n_starts, n_corners) &&
             indices_below(m->voronoi_face_points, n_corners, m->n_voronoi_points, false) &&
             indices_below(m->voronoi_face_cells, 2 * m->n_voronoi_faces, m->n_cells, true)));
}

// Arrays of equal length with what they describe: the schema's check has seen to it
// that they are, where both are present.
tf_status tf_mesh_view(const tp_arrays *set, const char *path, tf_mesh *ret_mesh, tf_error *error) {
    tf_mesh m = {0};
    tp_error why;
    if (tp_arrays_validate(set, tp_schema_mesh(), &why) != TP_OK) {
        return tf_error_set(error, TF_E_MALFORMED, "%s: the mesh to write: %s", path, why.message);
    }
    m.points = tp_arrays_data(set, "points", &m.n_points);
    m.tetrahedra = tp_arrays_data(set, "tetrahedra", &m.n_tetrahedra);
    m.subfaces = tp_arrays_data(set, "subfaces", &m.n_subfaces);
    m.subsegments = tp_arrays_data(set, "subsegments", &m.n_subsegments);
    m.point_attributes = tp_arrays_data(set, "point_attributes", NULL);
    m.n_attributes =
        m.point_attributes != NULL ? tp_arrays_find(set, "point_attributes")->shape[1] : 0;
    m.point_markers = tp_arrays_data(set, "point_markers", NULL);
    m.point_origin = tp_arrays_data(set, "point_origin", NULL);
    m.tetrahedron_regions = tp_arrays_data(set, "tetrahedron_regions", NULL);
    m.neighbours = tp_arrays_data(set, "neighbours", NULL);
    m.subface_markers = tp_arrays_data(set, "subface_markers", NULL);
    m.subsegment_markers = tp_arrays_data(set, "subsegment_markers", NULL);
    m.region_markers = tp_arrays_data(set, "region_markers", &m.n_regions);
    m.region_attributes = tp_arrays_data(set, "region_attributes",
                                         m.region_markers == NULL ? &m.n_regions : NULL);
    if (m.region_markers == NULL && m.region_attributes == NULL) {
        m.tetrahedron_regions = NULL;
    }
    if (m.points == NULL || m.tetrahedra == NULL) {
        return tf_error_set(error, TF_E_MALFORMED, "%s: the mesh to write has no %s", path,
                            m.points == NULL ? "points" : "tetrahedra");
    }
    if (!indices_below(m.tetrahedra, 4 * m.n_tetrahedra, m.n_points, false) ||
        !indices_below(m.subfaces, 3 * m.n_subfaces, m.n_points, false) ||
        !indices_below(m.subsegments, 2 * m.n_subsegments, m.n_points, false) ||
        (m.neighbours != NULL &&
         !indices_below(m.neighbours, 4 * m.n_tetrahedra, m.n_tetrahedra, true)) ||
        (m.tetrahedron_regions != NULL &&
         !indices_below(m.tetrahedron_regions, m.n_tetrahedra, m.n_regions, false))) {
        return tf_error_set(error, TF_E_MALFORMED, "%s: the mesh to write has indices out of range",
                            path);
    }
    if (!view_dual(set, &m)) {
        return tf_error_set(error, TF_E_MALFORMED,
                            "%s: the Voronoi cells to write lack an array or do not fit", path);
    }
    *ret_mesh = m;
    return TF_OK;
}

int32_t tf_region_marker(const tf_mesh *mesh, uint64_t t) {
    return mesh->tetrahedron_regions != NULL && mesh->region_markers != NULL
               ? mesh->region_markers[mesh->tetrahedron_regions[t]]
               : 0;
}

int32_t tf_marker_of(const tf_mesh *mesh, uint32_t region) {
    return mesh->region_markers != NULL ? mesh->region_markers[region] : 0;
}

double tf_region_attribute(const tf_mesh *mesh, uint64_t t) {
    return mesh->tetrahedron_regions != NULL && mesh->region_attributes != NULL
               ? mesh->region_attributes[mesh->tetrahedron_regions[t]]
               : tf_region_marker(mesh, t);
}

typedef struct vector {
    double x, y, z;
} vector;

static vector minus(const double *a, const double *b) {
    return (vector){a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

static vector cross(vector a, vector b) {
    return (vector){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static double dot(vector a, vector b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vector sum(double s, vector a, double t, vector b, double u, vector c) {
    return (vector){s * a.x + t * b.x + u * c.x, s * a.y + t * b.y + u * c.y,
                    s * a.z + t * b.z + u * c.z};
}

static const double *corner(const tf_mesh *mesh, uint64_t t, int i) {
    return mesh->points + 3 * (size_t)mesh->tetrahedra[4 * t + (uint64_t)i];
}

double tf_radius_edge(const tf_mesh *mesh, uint64_t t) {
    const double *a = corner(mesh, t, 0);
    const vector u = minus(corner(mesh, t, 1), a), v = minus(corner(mesh, t, 2), a),
                 w = minus(corner(mesh, t, 3), a);
    const vector n = sum(dot(u, u), cross(v, w), dot(v, v), cross(w, u), dot(w, w), cross(u, v));
    const double radius = sqrt(dot(n, n)) / fabs(2 * dot(cross(u, v), w));
    double shortest = INFINITY;
    for (int i = 0; i < 4; i++) {
        for (int j = i + 1; j < 4; j++) {
            const vector e = minus(corner(mesh, t, i), corner(mesh, t, j));
            shortest = fmin(shortest, dot(e, e));
        }
    }
    return radius / sqrt(shortest);
}

double tf_least_dihedral(const tf_mesh *mesh, uint64_t t) {
    // Outward normals of a positive tetrahedron's faces, each opposite its vertex.
    static const int face[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    vector n[4];
    for (int i = 0; i < 4; i++) {
        const double *a = corner(mesh, t, face[i][0]);
        n[i] = cross(minus(corner(mesh, t, face[i][1]), a), minus(corner(mesh, t, face[i][2]), a));
    }
    double least = INFINITY;
    for (int i = 0; i < 4; i++) {
        for (int j = i + 1; j < 4; j++) {
            // atan2 keeps its digits near 0 and 180 degrees.
            const vector c = cross(n[i], n[j]);
            least = fmin(least, atan2(sqrt(dot(c, c)), -dot(n[i], n[j])));
        }
    }
    return least * (180 / 3.14159265358979323846);
}
