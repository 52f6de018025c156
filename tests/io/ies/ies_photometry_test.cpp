#include "io/ies/ies_photometry.h"

#include <gtest/gtest.h>

#include <random>

#include "core/base/math.h"
#include "io/base/file_error.h"
#include "io/ies/ies_file.h"
#include "support/ies_writer.h"
#include "support/photometries.h"
#include "support/temporary_folder.h"

namespace phat {
namespace {

using test::degreesFrom;
using test::IesWriter;

std::vector<uint8_t> bytesOf(const std::string& text) {
    return {text.begin(), text.end()};
}

Photometry read(const std::string& text) {
    return photometryOfIes(bytesOf(text), "test");
}

std::string reasonOf(const std::string& text) {
    try {
        read(text);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "";
}

// Degrees: about -z from +x toward +y.
glm::vec3 directionOf(double vertical, double horizontal) {
    const double v = double(kPi) / 180 * vertical, h = double(kPi) / 180 * horizontal;
    return {float(std::sin(v) * std::cos(h)), float(std::sin(v) * std::sin(h)), float(-std::cos(v))};
}

// Four axes of symmetry but for a part that has only those that it is asked for.
double lobes(double vertical, double horizontal) {
    const double v = double(kPi) / 180 * vertical, h = double(kPi) / 180 * horizontal;
    return 100 * (1.2 + std::cos(v)) + 40 * std::sin(v) * std::cos(2 * h);
}

IesWriter around(std::vector<double> horizontal) {
    IesWriter file;
    file.vertical = degreesFrom(0, 180, 5);
    file.horizontal = std::move(horizontal);
    file.candela = lobes;
    return file;
}

void expectSame(const Photometry& a, const Photometry& b) {
    for (double v = 1; v < 180; v += 13)
        for (double h = 0; h < 360; h += 7) {
            const glm::vec3 d = directionOf(v, h);
            const double peak = b.web().peakCandela;
            EXPECT_NEAR(a.at(d) * a.web().peakCandela, b.at(d) * peak, 1e-5 * peak) << v << ' ' << h;
        }
}

TEST(Ies, LumensAreThoseOfTheFormulas) {
    for (const test::PhotometricFormula& formula : test::photometricFormulas()) {
        IesWriter file =
            around(formula.horizontalSteps == 1 ? std::vector<double>{0} : degreesFrom(0, 360, 5));
        file.vertical = degreesFrom(0, 180, 180.0 / formula.verticalSteps);
        file.candela = [&](double v, double h) {
            return 250 * formula.value(double(kPi) / 180 * v, double(kPi) / 180 * h);
        };
        const Photometry photometry = read(file.text());
        // Steps of two degrees meet a peak that is at 45 within a degree of it.
        EXPECT_NEAR(photometry.web().peakCandela, 250, 250 * 6.1e-4) << formula.name;
        EXPECT_NEAR(photometry.lumens(), 250 * formula.solidAngle, 2e-3 * 250 * formula.solidAngle)
            << formula.name;
    }
}

TEST(Ies, SymmetricTablesAreTheFullOnes) {
    const Photometry full = read(around(degreesFrom(0, 360, 15)).text());
    expectSame(read(around(degreesFrom(0, 90, 15)).text()), full);
    expectSame(read(around(degreesFrom(0, 180, 15)).text()), full);
    expectSame(read(around(degreesFrom(90, 270, 15)).text()), full);
    expectSame(read(around(degreesFrom(0, 345, 15)).text()), full);  // without the angle that is 0 again
}

// The two planes of bilateral symmetry: of 0 and 180 degrees, and of 90 and 270.
TEST(Ies, EachHalfIsMirroredInItsOwnPlane) {
    const auto oneSided = [](double axis) {
        return [axis](double v, double h) {
            return 10 + 5 * std::sin(double(kPi) / 180 * v) * std::cos(double(kPi) / 180 * (h - axis));
        };
    };
    IesWriter half = around(degreesFrom(0, 180, 15)), full = around(degreesFrom(0, 360, 15));
    half.candela = full.candela = oneSided(0);
    expectSame(read(half.text()), read(full.text()));
    half.horizontal = degreesFrom(90, 270, 15);
    half.candela = full.candela = oneSided(90);
    expectSame(read(half.text()), read(full.text()));
}

TEST(Ies, FactorsMultiply) {
    IesWriter file = around({0});
    const float plain = read(file.text()).lumens();
    file.multiplier = 3, file.ballast = 0.5, file.second = 7;
    EXPECT_NEAR(read(file.text()).lumens(), 1.5f * plain, 1e-4f * plain);
    for (const char* title : {"IESNA91", "a lamp of 1986"}) {
        file.title = title;  // the second was a factor then
        EXPECT_NEAR(read(file.text()).lumens(), 10.5f * plain, 1e-3f * plain) << title;
    }
    file.title = "IES:LM-63-2019", file.second = 1.10001;  // how the file was made
    EXPECT_NEAR(read(file.text()).lumens(), 1.5f * plain, 1e-4f * plain);
}

TEST(Ies, TiltDataIsSkippedOrRefused) {
    IesWriter file = around({0});
    const float plain = read(file.text()).lumens();
    file.tilt = "TILT=INCLUDE\r\n1\r\n3\r\n0 45 90\r\n1 0.9 0.8";
    EXPECT_EQ(read(file.text()).lumens(), plain);
    file.tilt = "TILT=lamp.tlt";
    EXPECT_NE(reasonOf(file.text()).find("tilt data in another file, \"lamp.tlt\""), std::string::npos);
}

TEST(Ies, CommasAndAnEndOfDosSeparateAndEnd) {
    std::string text = around(degreesFrom(0, 90, 45)).text();
    const Photometry plain = read(text);
    for (size_t i = text.find("TILT") + 12; i < text.size(); ++i)
        if (text[i] == ' ') text[i] = ',';
    expectSame(read(text + "\x1a\x01\x02"), plain);
}

// Both have (0, 0) ahead; vertical angles go up, toward +x, horizontal angles to the right, toward -y.
TEST(Ies, FloodlightsAndHeadlamps) {
    IesWriter file;
    file.vertical = file.horizontal = degreesFrom(-90, 90, 2);
    file.candela = [](double v, double h) {
        return 100 * std::exp(-(v - 30) * (v - 30) / 200 - (h - 20) * (h - 20) / 200);
    };
    const auto at = [](const Photometry& photometry, glm::vec3 d) {
        return photometry.at(glm::normalize(d)) * photometry.web().peakCandela;
    };
    const float v = glm::radians(30.0f), h = glm::radians(20.0f);
    file.type = 2;  // turned about the horizontal axis, then along it
    const glm::vec3 ofB(std::cos(h) * std::sin(v), -std::sin(h), -std::cos(h) * std::cos(v));
    file.type = 3;  // turned about the vertical axis, then up
    const glm::vec3 ofA(std::sin(v), -std::cos(v) * std::sin(h), -std::cos(v) * std::cos(h));
    const Photometry headlamp = read(file.text());
    file.type = 2;
    const Photometry floodlight = read(file.text());
    EXPECT_NEAR(at(floodlight, ofB), 100, 1);
    EXPECT_NEAR(at(headlamp, ofA), 100, 1);
    EXPECT_LT(at(floodlight, ofA), 99);  // 2.6 degrees off
    EXPECT_LT(at(headlamp, ofB), 99);
    EXPECT_EQ(at(floodlight, {0, 0, 1}), 0);

    file.candela = [](double up, double right) { return up * up + 2 * std::abs(right) + 1; };
    const Photometry full = read(file.text());
    file.vertical = file.horizontal = degreesFrom(0, 90, 2);
    expectSame(read(file.text()), full);
}

// The flux of a floodlight that has the same intensity everywhere in front of it.
TEST(Ies, AFloodlightKeepsItsFlux) {
    IesWriter file;
    file.vertical = file.horizontal = degreesFrom(-90, 90, 10);
    file.candela = [](double, double) { return 10; };
    for (const int type : {2, 3}) {
        file.type = type;
        // The border at 90 degrees is a step of one degree wide.
        EXPECT_NEAR(read(file.text()).lumens(), 20 * kPi, 0.01f * 20 * kPi) << type;
    }
}

TEST(Ies, SaysWhatIsWrong) {
    IesWriter file = around({0});
    const std::string good = file.text();
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        const size_t at = text.find(from);
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        return reasonOf(text);
    };
    EXPECT_EQ(reasonOf(good), "");
    EXPECT_EQ(reasonOf(""), "has no line TILT=: not a photometric file of LM-63");
    EXPECT_EQ(with("TILT=NONE", "TILT"),
              "has its tilt data in another file, \"\", which is not read; TILT=NONE "
              "does without");
    EXPECT_EQ(with("1 -1 1 37", "1 -1 1"),
              "has the unit of length 0.1: 1 is feet, 2 metres");  // one number less
    EXPECT_EQ(with(" 37 1 1 2", " 1e18 1 1 2"), "is too short for its number of vertical angles of 1e+18");
    EXPECT_EQ(with(" 37 1 1 2", " 37 300 1 2"), "ends before its horizontal angles");
    EXPECT_EQ(with(" 37 1 1 2", " 3.5 1 1 2"), "has 3.5 as its number of vertical angles");
    EXPECT_EQ(with(" 37 1 1 2", " -1 1 1 2"), "has -1 as its number of vertical angles");
    EXPECT_EQ(with(" 37 1 1 2", " 37 1 4 2"), "has the photometric type 4");
    EXPECT_EQ(with(" 37 1 1 2", " 37 1 1 0"), "has the unit of length 0: 1 is feet, 2 metres");
    EXPECT_EQ(with("0 5 10", "0 10 5"), "its vertical angles do not ascend");
    EXPECT_EQ(with("0 5 10", "-5 5 10"), "has the vertical angle -5, which is not from 0 to 180");
    EXPECT_EQ(with("220 ", "-220 "), "has a negative intensity, -220 cd");
    EXPECT_EQ(with("220 ", "nan "), "\"nan\" is no number, where its intensities should be");
    EXPECT_EQ(with("220 ", "1e400 "), "\"1e400\" is no number, where its intensities should be");
    EXPECT_EQ(with("220 ", "1e13 "), "has an intensity of 1e+13 cd");
    EXPECT_EQ(with("220 ", "\x01 "), "holds the control character 0x01");
    file.candela = [](double, double) { return 0; };
    EXPECT_EQ(reasonOf(file.text()), "emits no light");
    file.candela = lobes;
    file.horizontal = degreesFrom(0, 45, 15);
    EXPECT_EQ(reasonOf(file.text()),
              "has horizontal angles from 0 to 45: they may end at 0, 90, 180 or 360, or be "
              "from 90 to 270");
    file.horizontal = {0};
    file.ballast = 0;
    EXPECT_EQ(reasonOf(file.text()), "multiplies its intensities by 0");
}

TEST(Ies, FilesAreNamedWithTheirFault) {
    const TemporaryFolder folder;
    const std::string path = folder.file("lamp.ies");
    writeBytes(path, {'x'});
    try {
        readIesFile(path);
        FAIL();
    } catch (const FileError& error) {
        EXPECT_EQ(error.path, path);
        EXPECT_EQ(error.reason, "has no line TILT=: not a photometric file of LM-63");
    }
    EXPECT_THROW(readIesFile(folder.file("none.ies")), FileError);
}

// Each prefix and thousands of damaged copies are either refused with a reason or are sound.
TEST(Ies, DamagedFilesAreRefusedOrSound) {
    const std::string good = around(degreesFrom(0, 90, 30)).text();
    const auto check = [](const std::string& text) {
        try {
            const Photometry photometry = read(text);
            ASSERT_EQ(photometry.web().relative.size(),
                      size_t(photometry.web().horizontalSteps) * (photometry.web().verticalSteps + 1));
            ASSERT_LE(photometry.web().relative.size() * 24, kMaxPhotometryBytes);
            ASSERT_TRUE(std::isfinite(photometry.lumens()) && photometry.lumens() > 0);
            ASSERT_TRUE(isUnit(photometry.sample({0.3f, 0.9f})));
            return;
        } catch (const std::runtime_error& error) {
            ASSERT_GT(std::string(error.what()).size(), 5u);
        }
    };
    for (size_t length = 0; length < good.size(); ++length) check(good.substr(0, length));
    std::mt19937 random(5);
    const auto below = [&](size_t n) { return size_t(random() % n); };
    const std::string_view digits = "0123456789-+.eE ,\r\n\tTNa\x01\xff";
    for (int i = 0; i < 20'000; ++i) {
        std::string text = good;
        for (size_t k = 0; k <= below(4); ++k) {
            const size_t at = below(text.size());
            switch (below(3)) {
                case 0:
                    text[at] = digits[below(digits.size())];
                    break;
                case 1:
                    text.erase(at, 1 + below(9));
                    break;
                default:
                    text.insert(at, 1 + below(5), digits[below(digits.size())]);
            }
        }
        check(text);
        if (HasFatalFailure()) FAIL() << text;
    }
}

}  // namespace
}  // namespace phat
