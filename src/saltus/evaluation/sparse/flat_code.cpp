#include <algorithm>
#include <array>
#include <iterator>

#include <casadi/core/sx.hpp>

#include "saltus/evaluation/sparse/flat_code_internal.hpp"

// Needs names that only the headers above bring.
#include <casadi/core/calculus.hpp>
#include <fmt/format.h>

namespace saltus::evaluation {
namespace {

/// Statements of one part: compilers need more than linear time for longer ones.
constexpr casadi_int part_length = 400;

/// An operation as an expression with {0} and {1} for the operands.
struct OperationForm {
  casadi_int operation;
  const char* text;
};

constexpr std::array operation_forms{
    OperationForm{casadi::OP_ASSIGN, "{0}"},       OperationForm{casadi::OP_ADD, "{0}+{1}"},
    OperationForm{casadi::OP_SUB, "{0}-{1}"},      OperationForm{casadi::OP_MUL, "{0}*{1}"},
    OperationForm{casadi::OP_DIV, "{0}/{1}"},      OperationForm{casadi::OP_NEG, "-{0}"},
    OperationForm{casadi::OP_SQ, "{0}*{0}"},       OperationForm{casadi::OP_TWICE, "2.*{0}"},
    OperationForm{casadi::OP_INV, "1./{0}"},       OperationForm{casadi::OP_SQRT, "sqrt({0})"},
    OperationForm{casadi::OP_EXP, "exp({0})"},     OperationForm{casadi::OP_LOG, "log({0})"},
    OperationForm{casadi::OP_SIN, "sin({0})"},     OperationForm{casadi::OP_COS, "cos({0})"},
    OperationForm{casadi::OP_TANH, "tanh({0})"},   OperationForm{casadi::OP_FABS, "fabs({0})"},
    OperationForm{casadi::OP_POW, "pow({0},{1})"}, OperationForm{casadi::OP_CONSTPOW, "pow({0},{1})"},
    OperationForm{casadi::OP_NE, "({0}!={1})"},    OperationForm{casadi::OP_IF_ELSE_ZERO, "({0}?{1}:0)"},
};

/// Empty for what is not known.
std::string form_of(casadi_int operation) {
  const auto* const found = std::find_if(operation_forms.begin(), operation_forms.end(),
                                         [&](const auto& form) { return form.operation == operation; });
  return found == operation_forms.end() ? "" : found->text;
}

/// One statement; empty for an operation that is not known.
std::string statement(const casadi::Function& function, casadi_int k) {
  const auto operation = function.instruction_id(k);
  const auto in = function.instruction_input(k);
  const auto out = function.instruction_output(k);
  if (operation == casadi::OP_CONST) {
    return fmt::format("w[{}]={:a};\n", out[0], function.instruction_constant(k));
  }
  if (operation == casadi::OP_INPUT) return fmt::format("w[{}]=arg[{}][{}];\n", out[0], in[0], in[1]);
  if (operation == casadi::OP_OUTPUT) return fmt::format("res[{}][{}]=w[{}];\n", out[0], out[1], in[0]);
  const std::string form = form_of(operation);
  if (form.empty() || in.empty()) return "";
  const std::string first = fmt::format("w[{}]", in[0]);
  const std::string second = in.size() > 1 ? fmt::format("w[{}]", in[1]) : "";
  return fmt::format("w[{}]={};\n", out[0], fmt::format(fmt::runtime(form), first, second));
}

/// What stands in for arguments and results that are not given.
std::string entry_point(const casadi::Function& function, casadi_int parts) {
  const std::string& name = function.name();
  casadi_int longest = 1;
  std::string text = fmt::format(
      "int {}(const double** given, double** wanted, casadi_int* iw, double* w, int mem) {{\n"
      "const double* arg[{}];\ndouble* res[{}];\n",
      name, function.n_in() + 1, function.n_out() + 1);
  for (casadi_int i = 0; i < function.n_in(); ++i) {
    longest = std::max(longest, function.nnz_in(i));
    text += fmt::format("arg[{0}]=given[{0}]?given[{0}]:{1}_zero;\n", i, name);
  }
  casadi_int most = 1;
  for (casadi_int i = 0; i < function.n_out(); ++i) {
    most = std::max(most, function.nnz_out(i));
    text += fmt::format("res[{0}]=wanted[{0}]?wanted[{0}]:unwanted;\n", i);
  }
  for (casadi_int part = 0; part < parts; ++part) text += fmt::format("{}_part{}(arg,res,w);\n", name, part);
  text += "(void)iw;(void)mem;\nreturn 0;\n}\n";
  const std::string declaration = fmt::format("double unwanted[{}];\n", most);
  text.insert(text.find("const double* arg["), declaration);
  return fmt::format("\nstatic const double {}_zero[{}]={{0}};\n__attribute__((visibility(\"default\")))\n", name,
                     longest) +
         text;
}

}  // namespace

std::string flat_code(const casadi::Function& function) {
  std::string text = "\n#include <math.h>\n";
  casadi_int parts = 0;
  const casadi_int count = function.n_instructions();
  for (casadi_int first = 0; first < count; first += part_length, ++parts) {
    text += fmt::format(
        "static __attribute__((noinline)) void {}_part{}(const double*const* restrict arg, double*const* restrict res, "
        "double* restrict w) {{\n",
        function.name(), parts);
    for (casadi_int k = first; k < std::min(first + part_length, count); ++k) {
      const std::string line = statement(function, k);
      if (line.empty()) return "";
      text += line;
    }
    text += "}\n";
  }
  return text + entry_point(function, parts);
}

}  // namespace saltus::evaluation
