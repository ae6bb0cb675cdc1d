// The heated rod of large_models.py by CVODE: BDF, exact Jacobian, KLU, its own root finding, a restart behind every
// root. Usage: rod_cvode N RTOL; writes the times of the switches, the final state of the last cell and the seconds of
// processor time. A peer of rod.py; not part of the build, which does not need SUNDIALS.
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

namespace {

struct Rod {
  sunindextype n;
  bool heated;
  [[nodiscard]] double scale() const { return static_cast<double>(n) * static_cast<double>(n); }
  [[nodiscard]] sunindextype middle() const { return (n + 1) / 2 - 1; }
};

int right_hand_side(realtype, N_Vector x, N_Vector slope, void* data) {
  const Rod& rod = *static_cast<Rod*>(data);
  const double* u = N_VGetArrayPointer(x);
  double* f = N_VGetArrayPointer(slope);
  const double scale = rod.scale();
  for (sunindextype i = 0; i < rod.n; ++i) {
    f[i] = -2.0 * u[i];
    f[i] += i > 0 ? scale * (u[i - 1] - u[i]) : rod.heated ? 4.0 * static_cast<double>(rod.n) : 0.0;
    if (i + 1 < rod.n) f[i] += scale * (u[i + 1] - u[i]);
  }
  return 0;
}

int threshold(realtype, N_Vector x, realtype* value, void* data) {
  *value = 0.5 - N_VGetArrayPointer(x)[static_cast<Rod*>(data)->middle()];
  return 0;
}

int jacobian(realtype, N_Vector, N_Vector, SUNMatrix matrix, void* data, N_Vector, N_Vector, N_Vector) {
  const Rod& rod = *static_cast<Rod*>(data);
  sunindextype* start = SUNSparseMatrix_IndexPointers(matrix);
  sunindextype* row = SUNSparseMatrix_IndexValues(matrix);
  double* value = SUNSparseMatrix_Data(matrix);
  sunindextype k = 0;
  for (sunindextype j = 0; j < rod.n; ++j) {
    start[j] = k;
    const double neighbours = (j > 0 ? 1.0 : 0.0) + (j + 1 < rod.n ? 1.0 : 0.0);
    if (j > 0) row[k] = j - 1, value[k++] = rod.scale();
    row[k] = j, value[k++] = -2.0 - neighbours * rod.scale();
    if (j + 1 < rod.n) row[k] = j + 1, value[k++] = rod.scale();
  }
  start[rod.n] = k;
  return 0;
}

void require(bool good, const char* what) {
  if (good) return;
  std::fprintf(stderr, "%s failed\n", what);
  std::exit(1);
}

}  // namespace

int main(int count, char** arguments) {
  require(count == 3, "usage: rod_cvode N RTOL");
  Rod rod{std::atol(arguments[1]), true};
  const double rtol = std::atof(arguments[2]);
  const double end = 5.0;
  const std::clock_t begin = std::clock();
  SUNContext context = nullptr;
  require(SUNContext_Create(nullptr, &context) == 0, "SUNContext_Create");
  N_Vector x = N_VNew_Serial(rod.n, context);
  N_VConst(0.0, x);
  void* memory = CVodeCreate(CV_BDF, context);
  SUNMatrix matrix = SUNSparseMatrix(rod.n, rod.n, 3 * rod.n, CSC_MAT, context);
  SUNLinearSolver solver = SUNLinSol_KLU(x, matrix, context);
  bool good = CVodeInit(memory, right_hand_side, 0.0, x) == CV_SUCCESS &&
              CVodeSStolerances(memory, rtol, 1e-2 * rtol) == CV_SUCCESS &&
              CVodeSetUserData(memory, &rod) == CV_SUCCESS &&
              CVodeSetLinearSolver(memory, solver, matrix) == CV_SUCCESS &&
              CVodeSetJacFn(memory, jacobian) == CV_SUCCESS && CVodeRootInit(memory, 1, threshold) == CV_SUCCESS &&
              CVodeSetMaxNumSteps(memory, 1000000) == CV_SUCCESS && CVodeSetStopTime(memory, end) == CV_SUCCESS;
  require(good, "setting up CVODE");
  double t = 0.0;
  long steps = 0;
  while (t < end) {
    const int flag = CVode(memory, end, x, &t, CV_NORMAL);
    require(flag >= 0, "CVode");
    if (flag != CV_ROOT_RETURN) continue;
    std::printf("switch %.17g\n", t);
    long own = 0;
    CVodeGetNumSteps(memory, &own);
    steps += own;
    rod.heated = !rod.heated;
    require(CVodeReInit(memory, t, x) == CV_SUCCESS, "CVodeReInit");
  }
  long own = 0;
  CVodeGetNumSteps(memory, &own);
  std::printf("last %.17g\n", N_VGetArrayPointer(x)[rod.n - 1]);
  std::printf("steps %ld\n", steps + own);
  std::printf("seconds %.6f\n", static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  SUNLinSolFree(solver);
  SUNMatDestroy(matrix);
  N_VDestroy(x);
  CVodeFree(&memory);
  SUNContext_Free(&context);
}
