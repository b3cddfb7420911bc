// SPDX-License-Identifier: Apache-2.0
/* format.h: files to and from the arrays of a PLS and of a mesh.
 *
 * Readers give the PLS array set of PROTOCOL.md ("Arrays"); writers take its mesh
 * array set. The formats are told by the file name's extension, in any case:
 *
 *   read   .poly .smesh .node (TetGen's text formats), .off, .stl (ASCII and
 *          binary), .ply (ASCII and binary), .obj, .mesh (Medit, ASCII)
 *   write  .node (.node .ele .face .edge beside each other, and .neigh where the
 *          mesh has neighbours), .mesh, .vtu, .off (the surface); the dual, where the
 *          mesh has one, as .v.volume .v.factor .v.share and .v.node .v.edge .v.face
 *          .v.cell beside .node, as .voronoi.vtu beside .vtu
 *
 * Numbers are read exactly (the nearest double) and written with 17 significant
 * digits, in any locale. No geometry is checked here: that is the engine's part. */
#ifndef TETRAD_FORMATS_FORMAT_H
#define TETRAD_FORMATS_FORMAT_H

#include <stdbool.h>
#include <stddef.h>

#include "clients/formats/output.h"
#include "protocol/array.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tf_format {
    TF_NODE = 0,
    TF_POLY,
    TF_SMESH,
    TF_OFF,
    TF_STL,
    TF_PLY,
    TF_OBJ,
    TF_MEDIT,
    TF_VTU
} tf_format;

/* The format of a path's extension. Errors: TF_E_FORMAT, naming the extension; then
 * *ret_format is untouched. */
tf_status tf_format_of(const char *path, tf_format *ret_format, tf_error *error);

/* A PLS as read. The arrays own their data. */
typedef struct tf_pls {
    tp_arrays arrays;
    int first_index; /* 0 or 1: the number of the first vertex in the file */
} tf_pls;

void tf_pls_free(tf_pls *pls);

/* Reads the file at `path`; .poly and .smesh whose point count is 0 also read the
 * .node beside it. On success *ret_pls is the caller's. Errors: TF_E_OPEN,
 * TF_E_FORMAT, TF_E_MALFORMED (file, line and what is wrong), TF_E_MEMORY; then
 * *ret_pls is untouched. Cost: linear; the file is held whole while it is read. */
tf_status tf_read(const char *path, tf_pls *ret_pls, tf_error *error);

/* Bytes of a file. bytes[size] must exist and be 0. */
typedef struct tf_file {
    const char *name; /* for messages */
    const char *bytes;
    size_t size;
} tf_file;

/* Reads a file that is in memory. `nodes` is the .node file for a .poly or .smesh
 * that needs one, else NULL. Errors as tf_read. */
tf_status tf_parse(tf_format format, const tf_file *file, const tf_file *nodes, tf_pls *ret_pls,
                   tf_error *error);

/* Whether a .poly or .smesh has its points in the .node file beside it. */
bool tf_wants_nodes(const tf_file *file);

/* What a mesh may have beyond its simplices. */
enum { TF_WITH_NEIGHBOURS = 1, TF_WITH_VORONOI = 2 };

/* Checks before any work that a mesh, with the given extras, can be written to `path`: the
 * extension is one that is written and has room for a dual, and the files can be created
 * where they belong. Leaves nothing behind. Errors: TF_E_FORMAT, TF_E_WRITE. */
tf_status tf_write_check(const char *path, unsigned extras, tf_error *error);

/* Writes a mesh to temporary files beside `path` and adds them to `set`, whose
 * tf_outputs_commit gives them their names. `first_index` is the number of the first
 * vertex, face ... in TetGen's formats; other formats have their own. Errors:
 * TF_E_FORMAT, TF_E_WRITE, TF_E_MALFORMED (the mesh lacks an array that the format
 * needs), TF_E_MEMORY; drop the set then. */
tf_status tf_write_mesh(tf_outputs *set, const char *path, const tp_arrays *mesh, int first_index,
                        tf_error *error);

#ifdef __cplusplus
}
#endif
#endif
