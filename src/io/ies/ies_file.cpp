#include "io/ies/ies_file.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "io/base/printable.h"

namespace phat {
namespace {

// Irradiance at any distance that a scene can have stays finite in a float.
constexpr double kMaxCandela = 1e12;
constexpr char kEndOfDosFile = 0x1a;

[[noreturn]] void fail(const std::string& reason) {
    throw std::runtime_error(reason);
}

void checkCharacters(std::string_view text) {
    for (const char c : text)
        if (uint8_t(c) < 0x20 && c != '\t' && c != '\n' && c != '\r' && c != '\f')
            fail(fmt::format("holds the control character 0x{:02x}", uint8_t(c)));
}

std::string_view takeLine(std::string_view& text) {
    const size_t end = std::min(text.find_first_of("\r\n"), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
}

// Numbers between blanks, commas and line ends.
class Numbers {
  public:
    explicit Numbers(std::string_view text) : text_(text) {}

    double next(const char* what) {
        text_.remove_prefix(std::min(text_.find_first_not_of(kBlanks), text_.size()));
        const std::string_view word = text_.substr(0, text_.find_first_of(kBlanks));
        if (word.empty()) fail(fmt::format("ends before its {}", what));
        text_.remove_prefix(word.size());
        const char* begin = word.data() + (word.front() == '+' ? 1 : 0);
        double value = 0;
        const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
        if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
            fail(fmt::format("\"{}\" is no number, where its {} should be",
                             printable(std::string(word.substr(0, 40))), what));
        return value;
    }
    // A whole number of things that take at least two bytes each in what is left of the file.
    size_t nextCount(const char* what) {
        const double count = next(what);
        if (!(count >= 1) || count != std::floor(count)) fail(fmt::format("has {:g} as its {}", count, what));
        if (count > double(text_.size())) fail(fmt::format("is too short for its {} of {:g}", what, count));
        return size_t(count);
    }
    std::vector<double> nextList(size_t count, const char* what) {
        if (count > text_.size()) fail(fmt::format("is too short for its {}", what));
        std::vector<double> values(count);
        for (double& value : values) value = next(what);
        return values;
    }

  private:
    static constexpr const char* kBlanks = " \t\r\n\f,";
    std::string_view text_;
};

// What is before the numbers: labels, and the line that says where tilt data are. Returns whether they
// follow.
bool takeLabels(std::string_view& text) {
    while (!text.empty()) {
        std::string_view line = takeLine(text);
        if (!line.starts_with("TILT")) continue;
        line.remove_prefix(std::min(line.find('='), line.size() - 1) + 1);
        const std::string value(line.substr(0, line.find_last_not_of(" \t") + 1));
        if (value == "NONE") return false;
        if (value == "INCLUDE") return true;
        fail(fmt::format(
            "has its tilt data in another file, \"{}\", which is not read; TILT=NONE does without",
            printable(value, 80)));
    }
    fail("has no line TILT=: not a photometric file of LM-63");
}

void skipTilt(Numbers& numbers) {
    numbers.next("lamp-to-luminaire geometry");
    const size_t count = numbers.nextCount("number of tilt angles");
    numbers.nextList(count, "tilt angles");
    numbers.nextList(count, "tilt factors");
}

void checkAngles(const std::vector<double>& angles, const char* which, double low, double high) {
    for (size_t i = 0; i < angles.size(); ++i) {
        if (!(angles[i] >= low && angles[i] <= high))
            fail(fmt::format("has the {} angle {:g}, which is not from {:g} to {:g}", which, angles[i], low,
                             high));
        if (i > 0 && !(angles[i] > angles[i - 1])) fail(fmt::format("its {} angles do not ascend", which));
    }
}

void checkTable(const IesTable& table) {
    const bool aroundAxis = table.type == GoniometerType::c;
    checkAngles(table.vertical, "vertical", aroundAxis ? 0 : -90, aroundAxis ? 180 : 90);
    checkAngles(table.horizontal, "horizontal", aroundAxis ? 0 : -90, aroundAxis ? 360 : 90);
    if (table.vertical.size() < 2) fail("has a single vertical angle");
    if (!aroundAxis && table.horizontal.size() < 2) fail("has a single horizontal angle");
    double brightest = 0;
    for (const double candela : table.candela) {
        if (!(candela >= 0)) fail(fmt::format("has a negative intensity, {:g} cd", candela));
        if (!(candela <= kMaxCandela)) fail(fmt::format("has an intensity of {:g} cd", candela));
        brightest = std::max(brightest, candela);
    }
    if (!(brightest > 0)) fail("emits no light");
}

}  // namespace

IesTable parseIes(std::span<const uint8_t> bytes) {
    std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    text = text.substr(0, text.find(kEndOfDosFile));
    checkCharacters(text);
    // The fields after the ballast factor have changed: since 1995 the second no longer is a factor.
    const std::string_view title = text.substr(0, text.find_first_of("\r\n"));
    const bool hasLampFactor = !title.starts_with("IESNA:LM-63-") && !title.starts_with("IES:LM-63-");
    const bool hasTilt = takeLabels(text);

    Numbers numbers(text);
    if (hasTilt) skipTilt(numbers);
    numbers.next("number of lamps");
    numbers.next("lumens per lamp");
    double factor = numbers.next("multiplier");
    const size_t verticalCount = numbers.nextCount("number of vertical angles");
    const size_t horizontalCount = numbers.nextCount("number of horizontal angles");
    const double type = numbers.next("photometric type");
    if (type != 1 && type != 2 && type != 3) fail(fmt::format("has the photometric type {:g}", type));
    const double unit = numbers.next("units of length");
    if (unit != 1 && unit != 2) fail(fmt::format("has the unit of length {:g}: 1 is feet, 2 metres", unit));
    for (const char* side : {"width", "length", "height"}) numbers.next(side);
    factor *= numbers.next("ballast factor");
    const double second = numbers.next("ballast-lamp factor");
    if (hasLampFactor) factor *= second;
    numbers.next("watts");
    if (!(factor > 0)) fail(fmt::format("multiplies its intensities by {:g}", factor));

    IesTable table;
    table.type = GoniometerType(int(type));
    table.vertical = numbers.nextList(verticalCount, "vertical angles");
    table.horizontal = numbers.nextList(horizontalCount, "horizontal angles");
    // Both counts are of numbers that were there, so that the product cannot wrap.
    table.candela = numbers.nextList(verticalCount * horizontalCount, "intensities");
    for (double& candela : table.candela) candela *= factor;
    checkTable(table);
    return table;
}

}  // namespace phat
