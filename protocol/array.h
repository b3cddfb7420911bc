// SPDX-License-Identifier: Apache-2.0
/* array.h: named typed arrays, sets of them, and the two schemas (PLS, mesh).
 *
 * The one model for formats, clients and worker; PROTOCOL.md, "Arrays",
 * tabulates it. Data is row-major, in the machine's memory as on the wire
 * (little-endian: the build refuses other machines). No JSON here, no I/O. */
#ifndef TETRAD_PROTOCOL_ARRAY_H
#define TETRAD_PROTOCOL_ARRAY_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/error.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum tp_dtype { TP_F8 = 0, TP_F4, TP_U4, TP_I4, TP_U8, TP_U1 } tp_dtype;
enum { TP_DTYPES = 6, TP_NAME_SIZE = 32 };

/* "<f8", "<f4", "<u4", "<i4", "<u8", "|u1". */
const char *tp_dtype_name(tp_dtype dtype);

/* The dtype of a name; false (and *ret_dtype untouched) if there is none. */
bool tp_dtype_of(const char *name, tp_dtype *ret_dtype);

/* Bytes of one element: 8, 4, 4, 4, 8, 1. */
size_t tp_dtype_size(tp_dtype dtype);

/* One array: shape [rows] (ndim 1) or [rows, columns] (ndim 2). */
typedef struct tp_array {
  char name[TP_NAME_SIZE]; /* lower case, digits, '_'; NUL-terminated */
  tp_dtype dtype;
  unsigned ndim;           /* 1 or 2 */
  uint64_t shape[2];       /* shape[1] >= 1, and 1 if ndim is 1 */
  void *data;              /* NULL allowed if there are no elements */
  bool owned;              /* data is freed (with free) together with the array */
} tp_array;

/* The bytes of `shape` elements of `dtype`. Errors: TP_E_PARAMS if the product
 * overflows or passes 2^53; then *ret_bytes is untouched. */
tp_code tp_shape_bytes(tp_dtype dtype, const uint64_t shape[2], uint64_t *ret_bytes);

/* The bytes of an array that is in a set (whose product was checked). */
size_t tp_array_bytes(const tp_array *array);

/* A set of arrays with different names, in the order in which they were added.
 * Start from {0} (TP_ARRAYS_INIT); free with tp_arrays_free. */
typedef struct tp_arrays {
  tp_array *items;
  size_t count;
  size_t capacity;
} tp_arrays;

#define TP_ARRAYS_INIT {NULL, 0, 0}

/* Frees the owned data and the set, which becomes empty and usable again. */
void tp_arrays_free(tp_arrays *set);

/* Adds an array that borrows `data`: the caller keeps it alive longer than the
 * set. columns 0: 1-dimensional of `rows`; else [rows, columns]. Errors:
 * TP_E_PARAMS (name too long, taken, or product over 2^53), TP_E_INTERNAL (no
 * memory); then nothing is added. */
tp_code tp_arrays_borrow(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows,
                         uint64_t columns, const void *data, tp_error *error);

/* Adds an array that owns `data`, which came from malloc. As tp_arrays_borrow;
 * on failure `data` stays the caller's. */
tp_code tp_arrays_own(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows,
                      uint64_t columns, void *data, tp_error *error);

/* Adds an array with fresh zeroed memory and gives it in *ret_data to be filled
 * (not NULL even if there are no elements). Errors as tp_arrays_borrow. */
tp_code tp_arrays_new(tp_arrays *set, const char *name, tp_dtype dtype, uint64_t rows,
                      uint64_t columns, void **ret_data, tp_error *error);

/* The array of that name, or NULL. Cost: linear; the pointer holds until the
 * next addition. */
const tp_array *tp_arrays_find(const tp_arrays *set, const char *name);

/* Typed look-up for the reader of a validated set: the data of `name` and its
 * rows, or NULL and 0 rows if it is absent. ret_rows may be NULL. An empty array
 * that is present gives a pointer that is not NULL. */
const void *tp_arrays_data(const tp_arrays *set, const char *name, uint64_t *ret_rows);

/* One row of a schema table. */
typedef struct tp_field {
  const char *name;
  tp_dtype dtype;
  unsigned columns;    /* 1: shape [n]; more: [n, columns]; TP_ANY_COLUMNS: [n, k], k >= 1 */
  bool required;
  const char *rows_of; /* needs that array, and has as many rows; NULL: free */
} tp_field;

enum { TP_ANY_COLUMNS = 0 };

typedef struct tp_schema {
  const char *name; /* "pls" or "mesh" */
  const tp_field *fields;
  size_t count;
} tp_schema;

/* The tables of PROTOCOL.md. */
const tp_schema *tp_schema_pls(void);
const tp_schema *tp_schema_mesh(void);

/* The row of that name, or NULL. */
const tp_field *tp_schema_find(const tp_schema *schema, const char *name);

/* Checks one name, dtype and shape against its row, data aside. Errors:
 * TP_E_PARAMS, `where` the array's name. */
tp_code tp_field_check(const tp_schema *schema, const char *name, tp_dtype dtype, unsigned ndim,
                       const uint64_t shape[2], tp_error *error);

/* Checks a whole set: every array is in the schema with its dtype and shape, the
 * required ones are there, equal rows are equal. For the PLS also: triangles and
 * polygon_* exclude each other, CSR starts begin at 0, never fall and end at the
 * number of what they index, and arrays that need another have it. Vertex indices
 * and coordinates are the engine's to check. Errors: TP_E_PARAMS, `where` the
 * array's name. Cost: linear in the CSR arrays. */
tp_code tp_arrays_validate(const tp_arrays *set, const tp_schema *schema, tp_error *error);

#ifdef __cplusplus
}
#endif
#endif
