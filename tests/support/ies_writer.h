#pragma once
// Photometric files made in the tests.

#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

namespace phat::test {

/// The fields of a file of LM-63; candela is a formula over vertical and horizontal degrees.
struct IesWriter {
    std::string title = "IESNA:LM-63-2002";
    std::string tilt = "TILT=NONE";
    double multiplier = 1, ballast = 1, second = 1;
    int type = 1;
    std::vector<double> vertical, horizontal;
    std::function<double(double, double)> candela;

    std::string text() const {
        std::string out = title + "\r\n[TEST] 1\r\n[MANUFAC] none\r\n" + tilt + "\r\n";
        out += fmt::format("1 -1 {} {} {} {} 2 0.1 0.2 0\r\n{} {} 40\r\n", multiplier, vertical.size(),
                           horizontal.size(), type, ballast, second);
        const auto line = [&](const auto& valueAt, size_t count) {
            for (size_t i = 0; i < count; ++i)
                out += fmt::format("{:.9g}{}", valueAt(i), i % 10 == 9 ? "\r\n" : " ");
            out += "\r\n";
        };
        line([&](size_t i) { return vertical[i]; }, vertical.size());
        line([&](size_t i) { return horizontal[i]; }, horizontal.size());
        for (const double h : horizontal)
            line([&](size_t i) { return candela(vertical[i], h); }, vertical.size());
        return out;
    }
};

/// `from`, `from` + `step`, ... `to`.
inline std::vector<double> degreesFrom(double from, double to, double step) {
    std::vector<double> angles;
    for (int i = 0; from + i * step <= to + 1e-9; ++i) angles.push_back(from + i * step);
    return angles;
}

}  // namespace phat::test
