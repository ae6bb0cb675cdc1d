// On what, and when, figures were measured.
#pragma once

#include <ctime>
#include <fstream>
#include <string>
#include <thread>

namespace compare {

/// "AMD EPYC, 2 processors, 2026-11-23"
inline std::string machine_and_day() {
  std::string line, processor = "unknown processor";
  std::ifstream info("/proc/cpuinfo");
  while (std::getline(info, line)) {
    const auto colon = line.find(": ");
    if (!line.starts_with("model name") || colon == std::string::npos) continue;
    processor = line.substr(colon + 2);
    break;
  }
  char day[16]{};
  const std::time_t now = std::time(nullptr);
  static_cast<void>(std::strftime(day, sizeof day, "%F", std::localtime(&now)));
  return processor + ", " + std::to_string(std::thread::hardware_concurrency()) + " processors, " + day;
}

}  // namespace compare
