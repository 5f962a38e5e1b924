// SPDX-License-Identifier: Apache-2.0
#pragma once

// Fortran's names of BLAS and LAPACK.
// NOLINTBEGIN(readability-identifier-naming)
extern "C" {
void drotg_(double* a, double* b, double* c, double* s);
void drot_(const int* n, double* x, const int* incx, double* y, const int* incy, const double* c,
           const double* s);
void dtrsm_(const char* side, const char* uplo, const char* transa, const char* diag, const int* m,
            const int* n, const double* alpha, const double* a, const int* lda, double* b, const int* ldb);
void spotrs_(const char* uplo, const int* n, const int* nrhs, const float* a, const int* lda, float* b,
             const int* ldb, int* info);
void dpotrs_(const char* uplo, const int* n, const int* nrhs, const double* a, const int* lda, double* b,
             const int* ldb, int* info);
// Null if another BLAS is linked.
[[gnu::weak]] void openblas_set_num_threads(int count);
[[gnu::weak]] char* openblas_get_config();
}
// NOLINTEND(readability-identifier-naming)
