#include "cli/lighting_options.h"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <sstream>

#include "cli/console.h"
#include "io/base/printable.h"
#include "io/ies/ies_photometry.h"

namespace phat {
namespace {

constexpr double kMaxPhotometryMultiplier = 1e6;

[[noreturn]] void refuse(const std::string& reason) {
    throw CLI::ValidationError("--sky", reason);
}

// The keys with their values; what has no key of its own is the second value of the one before.
std::map<std::string, std::vector<std::string>> keysOf(const std::string& text) {
    std::map<std::string, std::vector<std::string>> values;
    std::istringstream words(text);
    std::string key;
    for (std::string word; std::getline(words, word, ',');) {
        if (const size_t equals = word.find('='); equals != std::string::npos) {
            key = word.substr(0, equals);
            if (values.contains(key)) refuse(fmt::format("{} is given twice", key));
            word = word.substr(equals + 1);
        }
        if (key.empty()) refuse(fmt::format("\"{}\" is neither auto, none nor KEY=VALUE,...", text));
        values[key].push_back(word);
    }
    return values;
}

double numberOf(const std::string& key, const std::string& text, double low, double high) {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (text.empty() || *end != 0 || !(value >= low && value <= high))
        refuse(fmt::format("{}: \"{}\" is not a number from {:g} to {:g}", key, text, low, high));
    return value;
}

/// YYYY-MM-DDThh:mm, with :ss and Z or +hh:mm if wanted; without these it is universal time.
double julianDayOf(const std::string& text) {
    const auto wrong = [&] {
        refuse(fmt::format(
            "time: \"{}\" is not YYYY-MM-DDThh:mm, with Z or +hh:mm if it is not universal time", text));
    };
    int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, read = 0;
    if (std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d%n", &year, &month, &day, &hour, &minute, &read) != 5)
        wrong();
    std::string rest = text.substr(size_t(read));
    if (std::sscanf(rest.c_str(), ":%2d%n", &second, &read) == 1) rest = rest.substr(size_t(read));
    int zoneHour = 0, zoneMinute = 0;
    char sign = '+', more = 0;
    const bool zoned = !rest.empty() && rest != "Z";
    if (zoned && (std::sscanf(rest.c_str(), "%c%2d:%2d%c", &sign, &zoneHour, &zoneMinute, &more) != 3 ||
                  (sign != '+' && sign != '-')))
        wrong();
    const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(unsigned(month)),
                                           std::chrono::day(unsigned(day))};
    if (!date.ok() || hour < 0 || hour > 24 || minute < 0 || minute > 59 || second < 0 || second > 60 ||
        zoneHour < 0 || zoneHour > 14 || zoneMinute < 0 || zoneMinute > 59)
        wrong();
    const double days = double(std::chrono::sys_days(date).time_since_epoch().count());
    const double zone = (sign == '-' ? -1 : 1) * (zoneHour * 60 + zoneMinute);
    constexpr double kJulianDayOf1970 = 2440587.5;
    return kJulianDayOf1970 + days + (hour * 60 + minute - zone) / 1440.0 + second / 86400.0;
}

// LIGHT=FILE or LIGHT=FILE:MULTIPLIER. Names of lights may hold "=", those of files ":".
NamedPhotometry photometryOf(const std::string& text) {
    const size_t equals = text.rfind('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
        throw CLI::ValidationError("--ies", fmt::format("\"{}\" is not LIGHT=FILE", text));
    NamedPhotometry named{text.substr(0, equals), text.substr(equals + 1), {}};
    const size_t colon = named.path.rfind(':');
    if (colon != std::string::npos && !std::filesystem::exists(named.path)) {
        char* end = nullptr;
        named.multiplier = std::strtod(named.path.c_str() + colon + 1, &end);
        if (*end != 0 || !(named.multiplier > 0 && named.multiplier <= kMaxPhotometryMultiplier))
            throw CLI::ValidationError("--ies",
                                       fmt::format("\"{}\" is not a multiplier above 0 and up to {:g}",
                                                   named.path.substr(colon + 1), kMaxPhotometryMultiplier));
        named.path.resize(colon);
    }
    named.bytes = readIesFile(named.path);
    return named;
}

}  // namespace

void parseSky(const std::string& text, SceneLighting& lighting) {
    lighting.sky = SkyChoice::automatic;
    if (text == "auto") return;
    lighting.sky = text == "none" ? SkyChoice::none : SkyChoice::given;
    if (text == "none") return;
    const auto keys = keysOf(text);
    if (keys.empty()) refuse("is empty");
    for (const auto& [key, values] : keys) {
        const bool known =
            key == "sun" || key == "turbidity" || key == "time" || key == "latitude" || key == "longitude";
        if (!known)
            refuse(
                fmt::format("there is no \"{}\"; there are sun, time, latitude, longitude, turbidity", key));
        if (values.size() != (key == "sun" ? 2u : 1u))
            refuse(fmt::format("{} takes {}", key,
                               key == "sun" ? "two values, AZIMUTH,ELEVATION" : "one value"));
    }
    const auto number = [&](const char* key, size_t index, double low, double high) {
        return numberOf(key, keys.at(key)[index], low, high);
    };
    SunPosition& sun = lighting.daylight.sun;
    const bool timed = keys.contains("time"),
               placed = keys.contains("latitude") && keys.contains("longitude");
    if (timed != (keys.contains("latitude") || keys.contains("longitude")) || timed != placed)
        refuse("time, latitude and longitude need each other");
    if (timed && keys.contains("sun")) refuse("has the sun's position twice, by sun and by time");
    if (keys.contains("turbidity"))
        lighting.daylight.turbidity =
            float(number("turbidity", 0, double(kMinTurbidity), double(kMaxTurbidity)));
    if (keys.contains("sun")) sun = {float(number("sun", 0, -360, 360)), float(number("sun", 1, -90, 90))};
    if (timed)
        sun = sunPositionAt(julianDayOf(keys.at("time")[0]), number("latitude", 0, -90, 90),
                            number("longitude", 0, -180, 180));
    if (!(sun.elevationDegrees > 0))
        refuse(fmt::format("the sun is {:.1f} degrees below the horizon", -sun.elevationDegrees));
}

void declareLighting(const DeclareOption& declare, SceneLighting& lighting) {
    CLI::Option* environment =
        declare.value("--environment", "FILE", lighting.environment, "Sky: latitude-longitude .hdr or .exr");
    declare
        .value("--environment-rotation", "DEGREES", lighting.rotationDegrees,
               "Turns it, clockwise as seen from above")
        ->check(CLI::Range(-360.0, 360.0))
        ->needs(environment);
    declare.value("--environment-intensity", "F", lighting.intensity, "Multiplies its radiance")
        ->check(CLI::Range(0.0, 1e6))
        ->needs(environment);
    declare.command
        .add_option_function<std::string>(
            "--sky", [&lighting](const std::string& text) { parseSky(text, lighting); },
            "A clear sky: sun=AZIMUTH,ELEVATION (degrees; clockwise from -Z, so that +X is 90), or "
            "time=2026-06-21T15:00,latitude=52.5,longitude=13.4, and turbidity=2 to 10; none; "
            "auto: where the file has no light")
        ->type_name("SKY")
        ->default_str("auto")
        ->excludes(environment);
    declare.command
        .add_option_function<std::vector<std::string>>(
            "--ies",
            [&lighting](const std::vector<std::string>& texts) {
                for (const std::string& text : texts) lighting.photometries.push_back(photometryOf(text));
            },
            "The point or spot light of that name emits what a photometric file (LM-63) says, along -Z of "
            "its node; "
            "repeatable; :MULTIPLIER after the file dims it")
        ->type_name("LIGHT=FILE")
        ->take_all();
}

void printLines(const std::string& input, const std::vector<std::string>& lines) {
    for (const std::string& line : lines) tell(fmt::format("{}: {}\n", input, printable(line)));
}

}  // namespace phat
