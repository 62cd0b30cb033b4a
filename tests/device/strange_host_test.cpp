// A host without plan or manners: meshes in arrays and buffers, instances, lights, views, settings, budgets and both
// entry points in any order, with little memory. What it asks for may fail, by an error that says why. Validation stays
// silent, and when all of it is gone the pictures are those of a context that has seen none of it.
//
// GNOMON_STRANGE_SEEDS=FIRST:COUNT runs other seeds than the tests'.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <deque>
#include <limits>
#include <random>

#include "device/buffer_support.hpp"

using namespace gnomon;
using namespace gnomon::test;

namespace {

constexpr uint32_t kFrames = 60;
constexpr VkExtent2D kExtent{96, 54};

Scene baseScene()
{
    Scene scene = smallScene();
    scene.lights.push_back(pointLight("bulb", {-2.0, 3.0, 1.0}, false));
    return scene;
}

HostOptions optionsFor(uint32_t seed)
{
    constexpr std::array<uint64_t, 3> kMegabytes{0, 64, 24};
    HostOptions options{.extent = kExtent, .framesInFlight = 1 + seed % 3, .viewCount = 1 + seed % 2};
    options.flags = seed % 4 < 2 ? GnContextCreateFlags{GN_CONTEXT_NO_BACKGROUND_BIT} : 0;
    options.mapSide = seed % 5 != 0 ? 256.0 : 0.0;
    options.context = [limit = kMegabytes[seed % 3] << 20](GnContextCreateInfo& info) { info.memoryLimit = limit; };
    return options;
}

class StrangeHost {
public:
    explicit StrangeHost(uint32_t seed)
        : host_(baseScene(), optionsFor(seed)), random_(seed), methods_(availableMethods(host_.context))
    {
        host_.require(gnWarmUp(host_.context));
        for (const GnMethodInfo& method : methods_)
            for (uint32_t i = 0; i < method.settingCount; ++i)
                defaults_.push_back({method.pName, method.pSettings[i].pName, method.pSettings[i].value});
    }

    void run()
    {
        for (uint32_t frame = 0; frame < kFrames; ++frame) {
            CAPTURE(frame);
            for (uint32_t i = upTo(4); i > 0; --i)
                act();
            draw(frame);
        }
    }
    /// All that was made is gone, and all that was set is as before.
    void calmDown()
    {
        for (const GnInstance instance : instances_)
            gnDestroyInstance(host_.context, instance);
        for (const Mesh& mesh : meshes_)
            gnDestroyMesh(host_.context, mesh.handle);
        for (const GnLight light : lights_)
            gnDestroyLight(host_.context, light);
        for (const Setting& setting : defaults_)
            host_.require(gnSetMethodSetting(host_.context, setting.method, setting.name, setting.value));
        host_.resize(kExtent);
    }
    Host& host() { return host_; }
    uint32_t failures() const { return failures_; }

private:
    struct Mesh {
        GnMesh handle;
        demo::Mesh shape;
        const BufferFormat* format; ///< Null: of arrays.
    };

    struct Setting {
        const char *method, *name;
        double value;
    };

    uint32_t upTo(uint32_t most) { return std::uniform_int_distribution<uint32_t>(0, most)(random_); }
    bool oneIn(uint32_t count) { return upTo(count - 1) == 0; }
    double in(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    template <typename T>
    T& any(std::vector<T>& list)
    {
        return list[upTo(static_cast<uint32_t>(list.size()) - 1)];
    }
    template <typename T>
    T takeAny(std::vector<T>& list)
    {
        std::swap(any(list), list.back());
        T taken = list.back();
        list.pop_back();
        return taken;
    }

    /// What may be refused for memory, and for nothing else.
    bool made(GnResult result)
    {
        CHECK_MESSAGE((result >= 0 || result == GN_ERROR_OUT_OF_DEVICE_MEMORY), std::string(gnResultName(result))
                                                                                    << ": " << host_.lastError());
        return result >= 0;
    }

    void act()
    {
        using Act = void (StrangeHost::*)();
        static constexpr Act kActs[] = {
            &StrangeHost::addMesh,       &StrangeHost::addMesh,      &StrangeHost::rewriteMesh,
            &StrangeHost::rewriteMesh,   &StrangeHost::rewriteMesh,  &StrangeHost::destroyMesh,
            &StrangeHost::addInstances,  &StrangeHost::addInstances, &StrangeHost::moveInstances,
            &StrangeHost::moveInstances, &StrangeHost::swapMesh,     &StrangeHost::destroyInstance,
            &StrangeHost::addLight,      &StrangeHost::addLight,     &StrangeHost::changeLight,
            &StrangeHost::destroyLight,  &StrangeHost::pinLight,     &StrangeHost::pinLight,
            &StrangeHost::changeSetting, &StrangeHost::resize,       &StrangeHost::useWhatIsGone,
        };
        (this->*kActs[upTo(std::size(kActs) - 1)])();
    }

    demo::Mesh shape()
    {
        const auto size = static_cast<float>(in(0.1, 1.0));
        switch (upTo(3)) {
        case 0:
            return demo::makeSphere({.radius = size, .slices = 5 + upTo(30), .stacks = 3 + upTo(20)});
        case 1:
            return demo::makeTorus(
                {.radius = size, .tube = 0.3f * size, .ringSegments = 5 + upTo(20), .tubeSegments = 8});
        case 2:
            return demo::makeBox({.size = {size, 0.5f * size, 2.0f * size}});
        default:
            return demo::makePlane({});
        }
    }
    /// The same vertices elsewhere; of some nothing has an area.
    static demo::Mesh scaled(demo::Mesh mesh, const glm::vec3& by)
    {
        for (glm::vec3& position : mesh.positions)
            position *= by;
        return mesh;
    }

    void addMesh()
    {
        static const BufferFormat kFormats[] = {
            {.name = "floats"},
            {.name = "halves",
             .positions = VK_FORMAT_R16G16B16A16_SFLOAT,
             .stride = 8,
             .indices = VK_INDEX_TYPE_UINT16},
            {.name = "snorms", .positions = VK_FORMAT_R16G16B16A16_SNORM, .stride = 12, .vertexOffset = 7},
            {.name = "clockwise", .stride = 20, .frontFace = VK_FRONT_FACE_CLOCKWISE}};
        if (meshes_.size() >= 12) return;
        Mesh mesh{.handle = VK_NULL_HANDLE, .shape = shape(), .format = oneIn(3) ? nullptr : &kFormats[upTo(3)]};
        GnMeshCreateInfo info{};
        if (mesh.format) {
            info = buffers_.emplace_back(mesh.shape, *mesh.format).info(oneIn(4) ? GN_MESH_NO_CPU_COPY_BIT : 0);
        } else {
            info.pPositions = &mesh.shape.positions[0].x;
            info.positionCount = static_cast<uint32_t>(mesh.shape.positions.size());
            info.indexCount = static_cast<uint32_t>(mesh.shape.indices.size());
            info.pIndices = mesh.shape.indices.data();
        }
        if (made(gnCreateMesh(host_.context, &info, &mesh.handle))) meshes_.push_back(std::move(mesh));
    }
    void rewriteMesh()
    {
        if (meshes_.empty()) return;
        const Mesh& mesh = any(meshes_);
        const auto size = static_cast<float>(in(0.5, 1.5));
        const demo::Mesh now = scaled(mesh.shape, {size, oneIn(6) ? 0.0f : 1.0f, oneIn(12) ? 0.0f : size});
        if (!mesh.format) {
            const GnResult result = gnUpdateMeshPositions(host_.context, mesh.handle, &now.positions[0].x,
                                                          static_cast<uint32_t>(now.positions.size()), 0);
            if (result != GN_ERROR_EMPTY) made(result);
            return;
        }
        const VkDescriptorBufferInfo range = buffers_.emplace_back(now, *mesh.format).positionRange();
        made(gnUpdateMeshFromBuffer(host_.context, mesh.handle, &range, nullptr, nullptr));
    }
    void destroyMesh()
    {
        if (meshes_.empty()) return;
        gone_.mesh = takeAny(meshes_).handle; // of instances that cast on, or not
        gnDestroyMesh(host_.context, gone_.mesh);
    }

    GnTransform place()
    {
        GnTransform transform{};
        const auto size = static_cast<float>(in(0.3, 1.2));
        transform.basis[0] = oneIn(5) ? -size : size;
        transform.basis[4] = oneIn(5) ? 3.0f * size : size;
        transform.basis[8] = size;
        for (double& coordinate : transform.translation)
            coordinate = in(-4.0, 4.0);
        if (oneIn(20)) transform.translation[0] = 5000.0;
        return transform;
    }
    void addInstances()
    {
        if (meshes_.empty() || instances_.size() > 60) return;
        GnInstanceCreateInfo info{};
        info.mesh = any(meshes_).handle;
        if (oneIn(3)) info.flags |= GN_INSTANCE_STATIC_BIT;
        if (oneIn(5)) info.flags |= GN_INSTANCE_SINGLE_SIDED_BIT;
        if (oneIn(8)) info.flags |= GN_INSTANCE_ALPHA_TESTED_BIT | GN_INSTANCE_MAY_BE_MISSED_BIT;
        info.casterMask = oneIn(4) ? 1u << upTo(2) : 0u;
        std::vector<GnTransform> places(upTo(12));
        std::ranges::generate(places, [this] { return place(); });
        std::vector<GnInstance> out(places.size());
        const auto count = static_cast<uint32_t>(places.size());
        if (made(gnCreateInstances(host_.context, &info, count, places.data(), out.data())))
            instances_.insert(instances_.end(), out.begin(), out.end());
    }
    void moveInstances()
    {
        if (instances_.empty()) return;
        std::vector<GnInstance> some;
        std::vector<GnTransform> places;
        for (uint32_t i = upTo(20); i > 0; --i) { // one may be there twice
            some.push_back(any(instances_));
            places.push_back(place());
        }
        const bool wrong = !places.empty() && oneIn(6);
        if (wrong) any(places).translation[1] = std::numeric_limits<double>::quiet_NaN();
        const auto count = static_cast<uint32_t>(some.size());
        const GnResult result = gnSetInstanceTransforms(host_.context, count, some.data(), places.data());
        CHECK(result == (wrong ? GN_ERROR_NOT_A_NUMBER : GN_SUCCESS));
    }
    void swapMesh()
    {
        if (instances_.empty() || meshes_.empty()) return;
        host_.require(gnSetInstanceMesh(host_.context, any(instances_), any(meshes_).handle));
    }
    void destroyInstance()
    {
        if (instances_.empty()) return;
        gone_.instance = takeAny(instances_);
        gnDestroyInstance(host_.context, gone_.instance);
    }

    GnLightInfo light()
    {
        GnLightInfo info{};
        info.type = static_cast<GnLightType>(upTo(2));
        info.flags = oneIn(3) ? GN_LIGHT_STATIC_BIT : 0;
        for (int i = 0; i < 3; ++i) {
            info.position[i] = in(-4.0, 4.0) + (i == 1 ? 5.0 : 0.0);
            info.direction[i] = i == 1 ? -1.0f : static_cast<float>(in(-0.5, 0.5));
        }
        info.range = info.type == GN_LIGHT_TYPE_DIRECTIONAL || oneIn(4) ? 0.0f : static_cast<float>(in(2.0, 20.0));
        info.sourceRadius = oneIn(3) ? 0.2f : 0.0f;
        return info;
    }
    void addLight()
    {
        if (lights_.size() >= 5) return;
        const GnLightInfo info = light();
        GnLight handle = VK_NULL_HANDLE;
        host_.require(gnCreateLight(host_.context, &info, &handle));
        lights_.push_back(handle);
    }
    void changeLight()
    {
        if (lights_.empty()) return;
        const GnLightInfo info = light(); // perhaps of another kind
        host_.require(gnUpdateLight(host_.context, any(lights_), &info));
    }
    void destroyLight()
    {
        if (lights_.empty()) return;
        gone_.light = takeAny(lights_);
        gnDestroyLight(host_.context, gone_.light);
    }
    void pinLight()
    {
        if (lights_.empty()) return;
        const char* method = oneIn(4) ? nullptr : any(methods_).pName;
        const GnResult result = gnSetLightMethod(host_.context, any(lights_), method);
        CHECK((result == GN_SUCCESS || result == GN_ERROR_UNKNOWN_METHOD)); // not of this kind of light
    }
    void changeSetting()
    {
        const GnMethodInfo& method = any(methods_);
        if (method.settingCount == 0) return;
        const GnSettingInfo& setting = method.pSettings[upTo(method.settingCount - 1)];
        double value =
            std::clamp(std::floor(in(setting.minimum, setting.maximum + 0.99)), setting.minimum, setting.maximum);
        if (setting.maximum > 16.0) value = std::clamp(256.0 * (1 + upTo(3)), setting.minimum, setting.maximum);
        host_.require(gnSetMethodSetting(host_.context, method.pName, setting.pName, value));
    }
    void resize()
    {
        if (oneIn(2)) host_.resize({kExtent.width + 16 * upTo(6), kExtent.height + 9 * upTo(6)});
    }
    void useWhatIsGone()
    {
        const GnTransform transform = place();
        CHECK(gnSetInstanceTransform(host_.context, gone_.instance, &transform) == GN_ERROR_INVALID_HANDLE);
        CHECK(gnSetLightMethod(host_.context, gone_.light, nullptr) == GN_ERROR_INVALID_HANDLE);
        if (!instances_.empty())
            CHECK(gnSetInstanceMesh(host_.context, any(instances_), gone_.mesh) == GN_ERROR_INVALID_HANDLE);
        gnDestroyMesh(host_.context, gone_.mesh);
        gnDestroyInstance(host_.context, gone_.instance);
        gnDestroyLight(host_.context, gone_.light);
    }

    void draw(uint32_t frame)
    {
        std::vector<GnLight> lit = lights_;
        lit.insert(lit.end(), host_.lights.begin(), host_.lights.end());
        std::ranges::shuffle(lit, random_);
        if (oneIn(3)) lit.resize(upTo(static_cast<uint32_t>(lit.size())));
        constexpr std::array<float, 4> kBudgets{0.0f, 0.05f, 2.0f, 50.0f};
        FrameOptions options{.call = static_cast<Call>(upTo(2)), .time = 0.02 * frame, .lights = &lit};
        options.drop = options.call == Call::record && oneIn(3);
        options.adjust = [budget = kBudgets[upTo(3)], timed = oneIn(4)](GnFrameInfo& info, std::vector<GnViewFrame>&) {
            info.budgetMs = budget;
            info.flags = timed ? GN_FRAME_TIMED_BIT : 0;
        };
        GnResult result = host_.draw(options);
        if (options.call == Call::begin && result >= 0) do {
                result = host_.finish(oneIn(2) ? 0 : UINT64_MAX);
            } while (result == GN_TIMEOUT);
        failures_ += !made(result);
        if (result < 0) return;
        if (oneIn(3) && !options.drop) host_.pictures(upTo(static_cast<uint32_t>(host_.views.size()) - 1));
    }

    Host host_;
    std::mt19937 random_;
    std::vector<GnMethodInfo> methods_;
    std::vector<Setting> defaults_; ///< The infos of methods change with the settings.
    std::vector<Mesh> meshes_;
    std::deque<BufferMeshData> buffers_; ///< Frames in flight may read any.
    std::vector<GnInstance> instances_;
    std::vector<GnLight> lights_;
    struct {
        GnMesh mesh = VK_NULL_HANDLE;
        GnInstance instance = VK_NULL_HANDLE;
        GnLight light = VK_NULL_HANDLE;
    } gone_;
    uint32_t failures_ = 0;
};

std::vector<Image8> settled(Host& host, const char* method)
{
    host.pinAll(method);
    for (int i = 0; i < 6; ++i)
        while (host.draw() < 0) // what is gone makes room when frames in flight are completed
            host.pictures();
    for (size_t light = 0; light < host.lights.size(); ++light)
        CHECK(std::string(host.decision(light).pMethod) == method);
    return host.pictures();
}

std::pair<uint32_t, uint32_t> seeds()
{
    unsigned first = 1, count = 6;
    if (const char* given = std::getenv("GNOMON_STRANGE_SEEDS")) std::sscanf(given, "%u:%u", &first, &count);
    return {first, count};
}

} // namespace

TEST_CASE_FIXTURE(DeviceTest, "a host that does everything in any order, with little memory, leaves no trace")
{
    const auto [first, count] = seeds();
    for (uint32_t seed = first; seed < first + count; ++seed) {
        CAPTURE(seed);
        StrangeHost strange(seed);
        strange.run();
        CHECK(strange.failures() < kFrames / 2);
        strange.calmDown();
        Host fresh(baseScene(), optionsFor(seed));
        for (const std::string method : {"stencil_volume", "ray_traced"}) {
            CAPTURE(method);
            const std::vector<Image8> expected = settled(fresh, method.c_str());
            CHECK(dark(expected[0]) > 100);
            CHECK(differences(expected, settled(strange.host(), method.c_str())) == 0);
        }
    }
}
