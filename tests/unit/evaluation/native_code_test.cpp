#include "saltus/evaluation/native_code.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>
#include <unistd.h>

#include <gtest/gtest.h>

#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/evaluation/native_job.hpp"
#include "saltus/evaluation/sparse/flat_code_internal.hpp"
#include "saltus/model/system.hpp"

namespace saltus::evaluation {
namespace {

using casadi::SX;
namespace fs = std::filesystem;

/// A cache folder of its own, gone afterwards.
class NativeCodeTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("saltus-native-test-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    setenv("SALTUS_CACHE", folder_.c_str(), 1);
  }
  void TearDown() override {
    unsetenv("SALTUS_CACHE");
    unsetenv("CC");
    fs::remove_all(folder_);
  }
  fs::path folder_;
};

/// Every function of the expression language, and the guarded branches that the model layer writes.
model::System every_function() {
  model::System s;
  s.t = SX::sym("t");
  s.x = SX::sym("x", 3);
  s.u = SX(0, 1);
  s.p = SX::sym("p", 1);
  s.alpha = SX::sym("alpha", 1);
  s.parameter_values = {0.37};
  s.initial_state = {0, 0, 0};
  s.input = SX(0, 1);
  const SX a = s.x(0);
  const SX b = s.x(1);
  const SX c = s.x(2);
  const SX left = if_else_zero(s.alpha(0) != 0, s.alpha(0) * log(a * a));
  const SX right = if_else_zero(s.alpha(0) != 1, (1 - s.alpha(0)) * sqrt(b * b));
  s.f = SX::vertcat({sin(a) + cos(b) * tan(c) + pow(a * a, b) + pow(b, 3) - pow(c, 7) / (1 + c * c) + left + right,
                     asin(sin(a)) + acos(cos(b)) + atan(c) + atan2(a, b) + hypot(a, c) + s.p * s.t * fabs(a),
                     sinh(a) + cosh(b) * tanh(c) + exp(a - b) + log10(1 + a * a) + sqrt(1 + c * c) - 1 / (2 + a)});
  s.f_as_written = s.f;
  s.outputs = SX::vertcat({a * b + c});
  model::SwitchingFunction surface;
  surface.name = "s";
  surface.psi = sin(3 * a) - b * c + s.t;
  s.switching = {surface};
  return s;
}

bool same_bits(const double* a, const double* b, std::size_t n) { return std::memcmp(a, b, n * sizeof(double)) == 0; }

TEST_F(NativeCodeTest, IsBitIdenticalToTheInterpreter) {
  const auto interpreted = ModelKernel::compile(every_function(), NativeCode::off);
  const auto native = ModelKernel::compile(every_function(), NativeCode::on);
  ASSERT_TRUE(interpreted.has_value());
  ASSERT_TRUE(native.has_value()) << native.error().message;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-2.0, 2.0);
  for (int i = 0; i < 2000; ++i) {
    const double t = uniform(random);
    const double x[] = {uniform(random), uniform(random), uniform(random)};
    const double alpha[] = {i % 3 == 0 ? 0.0 : i % 3 == 1 ? 1.0 : 0.3};
    double one[3];
    double other[3];
    interpreted->field(t, x, alpha, one);
    native->field(t, x, alpha, other);
    ASSERT_TRUE(same_bits(one, other, 3)) << one[0] << " " << other[0];
    interpreted->functions(t, x, alpha, one);
    native->functions(t, x, alpha, other);
    ASSERT_TRUE(same_bits(one, other, 1));
    interpreted->scales(t, x, alpha, one, one + 1);
    native->scales(t, x, alpha, other, other + 1);
    ASSERT_TRUE(same_bits(one, other, 2));
  }
}

TEST_F(NativeCodeTest, IsCompiledOnceAndFoundByContent) {
  const std::string source = "double answer(void) { return 42.0; }\n";
  EXPECT_FALSE(find_native(source).has_value());
  const auto compiled = compile_native(source);
  ASSERT_TRUE(compiled.has_value()) << compiled.error().message;
  const auto found = find_native(source);
  ASSERT_TRUE(found.has_value());
  const auto answer = reinterpret_cast<double (*)()>(found->symbol("answer"));
  ASSERT_NE(answer, nullptr);
  EXPECT_EQ(answer(), 42.0);
  EXPECT_EQ(found->symbol("question"), nullptr);
  EXPECT_FALSE(find_native(source + " ").has_value());
}

TEST_F(NativeCodeTest, AStoredSourceThatDiffersIsNotTaken) {
  const std::string source = "double answer(void) { return 42.0; }\n";
  ASSERT_TRUE(compile_native(source).has_value());
  for (const auto& file : fs::directory_iterator(folder_)) {
    if (file.path().extension() == ".c") std::ofstream(file.path(), std::ios::app) << "/* another */";
  }
  EXPECT_FALSE(find_native(source).has_value());
}

TEST_F(NativeCodeTest, MissingOrFailingCompilerIsAnErrorOnlyWhereNativeIsInsistedOn) {
  setenv("CC", "/no/such/compiler", 1);
  const auto insisted = ModelKernel::compile(every_function(), NativeCode::on);
  ASSERT_FALSE(insisted.has_value());
  EXPECT_EQ(insisted.error().code, ErrorCode::not_available);
  EXPECT_FALSE(insisted.error().remedy.empty());
  EXPECT_TRUE(ModelKernel::compile(every_function(), NativeCode::automatic).has_value());
  unsetenv("CC");
  const auto refused = compile_native("this is no C");
  ASSERT_FALSE(refused.has_value());
  EXPECT_TRUE(fs::is_empty(folder_)) << "nothing half-written stays behind";
}

TEST_F(NativeCodeTest, AutomaticGoesOverToNativeInTheMiddleOfARun) {
  const auto interpreted = ModelKernel::compile(every_function(), NativeCode::off);
  const auto automatic = ModelKernel::compile(every_function(), NativeCode::automatic);
  ASSERT_TRUE(interpreted.has_value() && automatic.has_value());
  const double x[] = {0.3, -0.7, 1.1};
  const double alpha[] = {0.25};
  double one[3];
  double other[3];
  interpreted->field(0.5, x, alpha, one);
  const auto is_compiled = [&] {
    std::error_code none_yet;
    const auto files = fs::directory_iterator(folder_, none_yet);
    return std::any_of(begin(files), end(files), [](const auto& file) { return file.path().extension() == ".so"; });
  };
  // About 100 operations each: 1e8 of them are behind us well before the end, which only a failing compiler gets to.
  for (int i = 0; i < 400 && !is_compiled(); ++i) {
    for (int k = 0; k < 100000; ++k) automatic->field(0.5, x, alpha, other);
  }
  EXPECT_TRUE(is_compiled());
  automatic->field(0.5, x, alpha, other);
  EXPECT_TRUE(same_bits(one, other, 3));
}

TEST_F(NativeCodeTest, AJobThatIsGivenUpLeavesNothingBehind) {
  {
    const auto job = NativeJob::start("double answer(void) { return 42.0; }\n");
    ASSERT_TRUE(job.has_value());
  }
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(NativeCodeTest, LargeFunctionsInPartsHaveTheBitsOfTheInterpreter) {
  const casadi::SX x = casadi::SX::sym("x", 300);
  const casadi::SX y = casadi::SX::sym("y");
  std::vector<casadi::SX> rows;
  for (casadi_int i = 0; i < 300; ++i) {
    const casadi::SX a = x(i);
    const casadi::SX b = x((i + 7) % 300);
    const casadi::SX guarded = casadi::SX::if_else_zero(y != 0, sqrt(fabs(a)) * y);
    rows.push_back(sin(a * b) - a / (2 + b * b) + guarded + exp(-a) * pow(fabs(b), 1.5) - 0.1);
  }
  const casadi::Function large("large", {x, y}, {casadi::SX::vertcat(rows), sum1(x)});
  const std::string source = flat_code(large);
  ASSERT_FALSE(source.empty());
  const auto library = compile_native("#define casadi_int long long\n" + source);
  ASSERT_TRUE(library.has_value()) << library.error().message;
  using Native = int (*)(const double**, double**, long long*, double*, int);
  const auto native = reinterpret_cast<Native>(library->symbol("large"));
  ASSERT_NE(native, nullptr);
  std::vector<double> point(300);
  for (std::size_t i = 0; i < point.size(); ++i) point[i] = std::sin(static_cast<double>(i * i));
  for (const double side : {0.0, 0.7}) {
    const auto expected = large(std::vector<casadi::DM>{point, side});
    std::vector<double> values(300), work(large.sz_w());
    double sum = 0.0;
    const double* in[] = {point.data(), side == 0.0 ? nullptr : &side};  // what is not given is 0
    double* out[] = {values.data(), &sum};
    native(in, out, nullptr, work.data(), 0);
    EXPECT_EQ(values, expected[0].nonzeros());
    EXPECT_EQ(sum, expected[1].scalar());
    double* one_out[] = {values.data(), nullptr};
    native(in, one_out, nullptr, work.data(), 0);
    EXPECT_EQ(values, expected[0].nonzeros());
  }
  EXPECT_TRUE(flat_code(casadi::Function("other", {y}, {sinh(y)})).empty());
}

}  // namespace
}  // namespace saltus::evaluation
