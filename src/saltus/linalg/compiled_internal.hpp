#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseLU>

// Eigen's factorizations and products of matrices of doubles, compiled once in compiled.cpp. Each file that used one
// compiled it again: 15 to 40 seconds under the sanitizers, a fifth of the time of a build. The compiler is told to
// include this header first in the modules that link saltus_linalg. It is not for users of the package: their flags for
// vector instructions may differ from ours.
#ifdef SALTUS_COMPILES_EIGEN
#define SALTUS_COMPILED template
#else
#define SALTUS_COMPILED extern template
#endif

SALTUS_COMPILED class Eigen::ColPivHouseholderQR<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::FullPivLU<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::GeneralizedEigenSolver<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::JacobiSVD<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::LDLT<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::LLT<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::PartialPivLU<Eigen::MatrixXcd>;
SALTUS_COMPILED class Eigen::PartialPivLU<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>;
SALTUS_COMPILED class Eigen::SparseLU<Eigen::SparseMatrix<double>>;

namespace Eigen::internal {
SALTUS_COMPILED struct general_matrix_matrix_product<Index, double, ColMajor, false, double, ColMajor, false, ColMajor,
                                                     1>;
SALTUS_COMPILED struct general_matrix_matrix_product<Index, double, RowMajor, false, double, ColMajor, false, ColMajor,
                                                     1>;
SALTUS_COMPILED struct general_matrix_matrix_product<Index, double, ColMajor, false, double, RowMajor, false, ColMajor,
                                                     1>;
SALTUS_COMPILED struct general_matrix_matrix_product<Index, double, RowMajor, false, double, RowMajor, false, ColMajor,
                                                     1>;
SALTUS_COMPILED struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor, 0, 1>,
                                   gebp_traits<double, double>::mr, gebp_traits<double, double>::nr, false, false>;
SALTUS_COMPILED struct triangular_solve_vector<double, double, Index, OnTheLeft, Lower, false, ColMajor>;
SALTUS_COMPILED struct triangular_solve_vector<double, double, Index, OnTheLeft, Lower, false, RowMajor>;
SALTUS_COMPILED struct triangular_solve_vector<double, double, Index, OnTheLeft, UnitLower, false, ColMajor>;
SALTUS_COMPILED struct triangular_solve_vector<double, double, Index, OnTheLeft, Upper, false, ColMajor>;
SALTUS_COMPILED struct triangular_solve_vector<double, double, Index, OnTheLeft, Upper, false, RowMajor>;
}  // namespace Eigen::internal

#undef SALTUS_COMPILED
