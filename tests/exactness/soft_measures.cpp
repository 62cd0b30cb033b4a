#include "exactness/soft_measures.hpp"

#include <algorithm>
#include <cmath>

#include <glm/gtc/quaternion.hpp>

#include "demo/scene/primitives.hpp"
#include "exactness/testbed.hpp"

namespace gnomon::exact {
namespace {

/// Square of the correlation of y with x.
double rSquared(const std::vector<double>& x, const std::vector<double>& y)
{
    double n = double(x.size()), sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
    for (size_t i = 0; i < x.size(); ++i) {
        sx += x[i];
        sy += y[i];
        sxx += x[i] * x[i];
        sxy += x[i] * y[i];
        syy += y[i] * y[i];
    }
    const double top = n * sxy - sx * sy;
    return top * top / ((n * sxx - sx * sx) * (n * syy - sy * sy));
}

} // namespace

double widthOnFloor(const Stage& stage, const Image8& picture)
{
    const brute::View view = bruteView(stage);
    const brute::Light light = bruteLight(stage, 0);
    const brute::Scene casters(bruteTriangles(stage));
    double n = 0.0, x = 0.0, v = 0.0, xv = 0.0, vv = 0.0;
    for (int py = 0; py < view.height; ++py) {
        for (int px = 0; px < view.width; ++px) {
            const auto ux = static_cast<uint32_t>(px), uy = static_cast<uint32_t>(py);
            const double seen = *picture.at(ux, uy) / 255.0;
            if (seen < 0.1 || seen > 0.9) continue;
            const brute::Answer answer = brute::answerAt(view, light, casters, px, py, *stage.surfaces.depth.at(ux, uy),
                                                         drawnNormal(stage, ux, uy));
            if (answer.state != brute::State::asked || std::abs(answer.receiver.y) > 0.01) continue;
            if (std::abs(answer.receiver.z - 0.3) > 0.5) continue; // under the lamp
            n += 1.0;
            x += answer.receiver.x;
            v += seen;
            xv += answer.receiver.x * seen;
            vv += seen * seen;
        }
    }
    REQUIRE(n > 20.0);
    return 0.8 * (n * xv - x * v) / (n * vv - v * v);
}

void checkLinear(std::span<const char* const> methods, LightKind kind, float radius, double lowest)
{
    std::vector<double> wanted;
    std::vector<std::vector<double>> found(methods.size());
    const bool sun = kind == LightKind::Directional;
    for (const double height : {0.2, 0.5, 0.9, 1.4, 1.9}) {
        if (height < lowest) continue;
        Stage stage(halfPlane(kind, height, radius), {240, 180});
        const double traced = widthOnFloor(stage, stage.draw("ray_traced", {{"samples", 256.0}})[0]);
        wanted.push_back(sun ? height
                             : height / (4.0 - height)); // a sun's penumbra is as wide as its distance is large
        for (size_t i = 0; i < methods.size(); ++i) {
            found[i].push_back(widthOnFloor(stage, stage.draw(methods[i], {{"resolution", sun ? 2048.0 : 1024.0}})[0]));
            MESSAGE(std::string(methods[i]) << " " << std::string(demo::nameOf(kind)) << ", sheet at " << height
                                            << " m: penumbra " << found[i].back() << " m wide, traced " << traced);
            CHECK(std::abs(found[i].back() - traced) <= 0.12 * traced + 0.01);
        }
    }
    for (size_t i = 0; i < methods.size(); ++i) {
        const double linear = rSquared(wanted, found[i]);
        MESSAGE(std::string(methods[i]) << " " << std::string(demo::nameOf(kind)) << ": R^2 " << linear);
        CHECK(linear >= 0.95);
        CHECK(found[i].back() > 0.7 * wanted.back() / wanted.front() * found[i].front());
    }
}

Scene umbraScene(LightKind kind, float radius)
{
    Scene scene = softScene(Caster::box, kind, 0.9, radius);
    place(scene, "lid", demo::makeBox({.size = glm::vec3(2.4f, 0.1f, 2.4f)}), {1.2, 0.6, -1.2});
    return scene;
}

UmbraCount countUmbra(const Image8& picture, const SoftTruth& truth)
{
    const auto width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
    UmbraCount count;
    for (int y = 2; y + 2 < height; ++y) {
        for (int x = 2; x + 2 < width; ++x) {
            double least = 1.0, most = 0.0;
            bool asked = true;
            for (int dy = -2; dy <= 2; ++dy) {
                for (int dx = -2; dx <= 2; ++dx) {
                    const auto at = static_cast<size_t>((y + dy) * width + x + dx);
                    least = std::min(least, truth.visibility[at]);
                    most = std::max(most, truth.visibility[at]);
                    asked = asked && truth.asked[at] != 0;
                }
            }
            if (!asked) continue;
            const uint8_t seen = picture.texels[static_cast<size_t>(y * width + x)];
            if (most == 0.0) {
                ++count.umbra;
                count.leaks += seen > 0;
            } else if (least == 1.0) {
                ++count.light;
                count.specks += seen < 250;
            }
        }
    }
    return count;
}

std::string inWords(const UmbraCount& count)
{
    return "umbra " + std::to_string(count.umbra) + " pixels, leaks " + std::to_string(count.leaks) + "; light " +
           std::to_string(count.light) + ", specks " + std::to_string(count.specks);
}

} // namespace gnomon::exact
