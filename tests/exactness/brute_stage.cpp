#include "exactness/brute_stage.hpp"

namespace gnomon::exact {

brute::View bruteView(const Stage& stage)
{
    brute::View view;
    view.eye = stage.camera.eye;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            view.viewFromWorld[size_t(3 * row + column)] = stage.camera.viewFromWorld[column][row];
    for (int i = 0; i < 16; ++i)
        view.projection[size_t(i)] = stage.camera.projection[i / 4][i % 4];
    view.width = static_cast<int>(stage.surfaces.depth.width);
    view.height = static_cast<int>(stage.surfaces.depth.height);
    view.convention = stage.scene().depth.convention == demo::DepthConvention::Standard ? GN_DEPTH_STANDARD
                                                                                        : GN_DEPTH_REVERSED_INFINITE;
    return view;
}

brute::Light bruteLight(const Stage& stage, size_t layer)
{
    const uint32_t index = stage.present[layer];
    const GnLightInfo info = demo::toGnLight(stage.scene().lights[index], stage.state.lights[index]);
    brute::Light light;
    light.type = info.type;
    light.position = {info.position[0], info.position[1], info.position[2]};
    light.direction = {info.direction[0], info.direction[1], info.direction[2]};
    light.range = static_cast<double>(info.range);
    light.coneAngle = static_cast<double>(info.coneAngle);
    return light;
}

std::vector<brute::Triangle> bruteTriangles(const Stage& stage)
{
    std::vector<brute::Triangle> triangles;
    for (size_t i = 0; i < stage.scene().instances.size(); ++i) {
        const GnTransform t = demo::toGnTransform(stage.state.instances[i]);
        const demo::Mesh& mesh = stage.scene().meshes[stage.scene().instances[i].mesh];
        const auto world = [&](uint32_t index) {
            const glm::dvec3 p(mesh.positions[index]);
            glm::dvec3 out;
            for (int row = 0; row < 3; ++row)
                out[row] = double(t.basis[3 * row]) * p.x + double(t.basis[3 * row + 1]) * p.y +
                           double(t.basis[3 * row + 2]) * p.z + t.translation[row];
            return out;
        };
        for (size_t k = 0; k < mesh.indices.size(); k += 3)
            triangles.push_back({world(mesh.indices[k]), world(mesh.indices[k + 1]), world(mesh.indices[k + 2])});
    }
    return triangles;
}

glm::dvec3 drawnNormal(const Stage& stage, uint32_t x, uint32_t y)
{
    const float* n = stage.surfaces.normals.at(x, y);
    return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])};
}

} // namespace gnomon::exact
