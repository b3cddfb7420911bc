// SPDX-License-Identifier: Apache-2.0
// The reader of this format takes any bytes.
#include "fuzz_format.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    return fuzz_format(TF_SMESH, data, size);
}
