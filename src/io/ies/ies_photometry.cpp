#include "io/ies/ies_photometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <stdexcept>

#include "io/base/plain_file.h"
#include "io/ies/ies_file.h"

namespace phat {
namespace {

constexpr double kHalfTurn = 3.14159265358979324, kDegree = kHalfTurn / 180;

// Of tables whose angles are not the grid's, and of those that end in the light: the border is as wide as a
// step.
constexpr int kFineSteps = 180;
// Of a catalogue's lamp: some 100 kB.
constexpr uint64_t kMaxFileBytes = 64 << 20;

// Where an angle lies between two of an ascending list; `inside` is false beyond its ends.
struct Place {
    size_t low = 0;
    double fraction = 0;
    bool inside = true;
};
Place placeOf(const std::vector<double>& angles, double angle) {
    constexpr double kSlack = 1e-7;
    if (angles.size() == 1) return {};
    if (angle < angles.front() - kSlack || angle > angles.back() + kSlack) return {0, 0, false};
    const auto after = std::upper_bound(angles.begin() + 1, angles.end() - 1, angle);
    const size_t low = size_t(after - angles.begin()) - 1;
    const double fraction = (angle - angles[low]) / (angles[low + 1] - angles[low]);
    return {low, std::clamp(fraction, 0.0, 1.0), true};
}

double candelaAt(const IesTable& table, double vertical, double horizontal) {
    const Place v = placeOf(table.vertical, vertical), h = placeOf(table.horizontal, horizontal);
    if (!v.inside || !h.inside) return 0;
    const auto column = [&](size_t index) {
        const double* at = &table.candela[index * table.vertical.size() + v.low];
        return at[0] + v.fraction * (at[1] - at[0]);
    };
    if (table.horizontal.size() == 1) return column(0);
    return column(h.low) + h.fraction * (column(h.low + 1) - column(h.low));
}

double smallestStep(const std::vector<double>& angles, double most) {
    double step = most;
    for (size_t i = 1; i < angles.size(); ++i) step = std::min(step, angles[i] - angles[i - 1]);
    return step;
}

int stepsOver(double degrees, double step, int most) {
    return int(std::clamp(std::ceil(degrees / step - 1e-6), 1.0, double(most)));
}

// The horizontal angle of the table that stands for one of a whole turn.
double foldedHorizontal(const std::vector<double>& horizontal, double angle) {
    const double last = horizontal.back();
    if (horizontal.size() == 1) return 0;
    if (horizontal.front() == 90 && last == 270)
        return angle > 270 || angle < 90 ? std::fmod(540 - angle, 360) : angle;
    if (last <= 180 && angle > 180) angle = 360 - angle;
    if (last <= 90 && angle > 90) angle = 180 - angle;
    return angle;
}

void checkSymmetry(const std::vector<double>& horizontal) {
    const double first = horizontal.front(), last = horizontal.back();
    const bool known = (first == 0 && (last == 0 || last == 90 || last == 180 || last > 180)) ||
                       (first == 90 && last == 270);
    if (!known)
        throw std::runtime_error(
            fmt::format("has horizontal angles from {:g} to {:g}: they may end at 0, 90, 180 or 360, or be "
                        "from 90 to 270",
                        first, last));
}

// Some files have a whole turn but for the angle of 360 degrees, which is that of 0 again.
void closeTurn(IesTable& table) {
    if (table.horizontal.front() != 0 || table.horizontal.back() <= 180 || table.horizontal.back() == 360)
        return;
    table.horizontal.push_back(360);
    const std::vector<double> first(table.candela.begin(),
                                    table.candela.begin() + ptrdiff_t(table.vertical.size()));
    table.candela.insert(table.candela.end(), first.begin(), first.end());
}

// Whether light ends at an angle at which the table ends, but directions do not.
bool endsInLight(const IesTable& table) {
    const size_t rows = table.vertical.size();
    const auto lit = [&](size_t row) {
        for (size_t i = row; i < table.candela.size(); i += rows)
            if (table.candela[i] > 0) return true;
        return false;
    };
    return (table.vertical.front() > 0 && lit(0)) || (table.vertical.back() < 180 && lit(rows - 1));
}

using Candela = std::function<double(double, double)>;  // over vertical and horizontal radians of the web

PhotometricWeb sampledWeb(int verticalSteps, int horizontalSteps, const Candela& candela) {
    std::vector<double> values;
    for (int h = 0; h < horizontalSteps; ++h)
        for (int v = 0; v <= verticalSteps; ++v)
            values.push_back(candela(kHalfTurn * v / verticalSteps, 2 * kHalfTurn * h / horizontalSteps));
    PhotometricWeb web;
    web.verticalSteps = verticalSteps;
    web.horizontalSteps = horizontalSteps;
    const double peak = *std::max_element(values.begin(), values.end());
    if (!(peak > 0)) throw std::runtime_error("emits no light");
    web.peakCandela = float(peak);
    for (const double value : values) web.relative.push_back(float(value / peak));
    return web;
}

PhotometricWeb webAroundAxis(IesTable table) {
    checkSymmetry(table.horizontal);
    closeTurn(table);
    int rows = stepsOver(180, smallestStep(table.vertical, 180), kMaxVerticalSteps);
    if (endsInLight(table) && rows < kFineSteps) rows *= (kFineSteps + rows - 1) / rows;
    const int columns = table.horizontal.size() == 1
                            ? 1
                            : stepsOver(360, smallestStep(table.horizontal, 90), kMaxHorizontalSteps);
    return sampledWeb(std::min(rows, kMaxVerticalSteps), columns, [&](double vertical, double horizontal) {
        return candelaAt(table, vertical / kDegree, foldedHorizontal(table.horizontal, horizontal / kDegree));
    });
}

// Types A and B have vertical angles in the plane of x and z, those of horizontal angle 0, and horizontal
// angles clockwise as seen from +x, the lamp's upper side: EXT_lights_ies. Half a table stands for both its
// sides.
PhotometricWeb webAcrossAxis(const IesTable& table) {
    const bool headlamp = table.type == GoniometerType::a;
    const bool halfVertical = table.vertical.front() == 0, halfHorizontal = table.horizontal.front() == 0;
    return sampledWeb(kFineSteps, kFineSteps, [&](double polar, double azimuth) {
        const double forward = std::cos(polar), up = std::sin(polar) * std::cos(azimuth),
                     right = -std::sin(polar) * std::sin(azimuth);
        if (forward < -1e-9) return 0.0;
        double vertical = headlamp ? std::asin(std::clamp(up, -1.0, 1.0)) : std::atan2(up, forward);
        double horizontal = headlamp ? std::atan2(right, forward) : std::asin(std::clamp(right, -1.0, 1.0));
        if (halfVertical) vertical = std::abs(vertical);
        if (halfHorizontal) horizontal = std::abs(horizontal);
        return candelaAt(table, vertical / kDegree, horizontal / kDegree);
    });
}

}  // namespace

Photometry photometryOfIes(std::span<const uint8_t> bytes, const std::string& name) {
    const IesTable table = parseIes(bytes);
    PhotometricWeb web = table.type == GoniometerType::c ? webAroundAxis(table) : webAcrossAxis(table);
    web.name = name;
    return Photometry(std::move(web));
}

std::vector<uint8_t> readIesFile(const std::string& path) {
    requirePlainFile(path);
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    const auto size = file ? int64_t(file.tellg()) : -1;
    if (size < 0) throw FileError(path, "cannot be read");
    if (uint64_t(size) > kMaxFileBytes) throw FileError(path, "is too large for a photometric file");
    std::vector<uint8_t> bytes(static_cast<size_t>(size));
    file.seekg(0);
    if (!file.read(reinterpret_cast<char*>(bytes.data()), std::streamsize(size)))
        throw FileError(path, "cannot be read");
    try {
        photometryOfIes(bytes, path);
    } catch (const std::runtime_error& error) {
        throw FileError(path, error.what());
    }
    return bytes;
}

}  // namespace phat
