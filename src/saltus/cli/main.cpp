#include "saltus/cli/tool.hpp"

int main(int argc, char** argv) { return saltus::cli::run_tool(argc, argv); }
