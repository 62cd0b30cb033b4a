#pragma once
// The scenes that stand in for those of the theses on hybrid shadows (demo/scenes/views), drawn by one method after
// another within one context, with the truth beside them. One directional light, three cameras each.

#include <map>
#include <string>
#include <vector>

#include "demo/program/error_count.hpp"
#include "demo/program/session.hpp"
#include "demo/program/setting_choices.hpp"

namespace gnomon::demo {

/// Where the camera looks, against the way light travels.
enum class Look : uint8_t { side, with, against };
inline constexpr Look kLooks[] = {Look::side, Look::with, Look::against};
const char* nameOf(Look look) noexcept;

struct ViewScene {
    const char* file;   ///< In demo/scenes/views.
    uint32_t frames[3]; ///< By Look.
};
inline constexpr ViewScene kPrimitivesView{"primitives", {0, 90, 180}};
inline constexpr ViewScene kBenchView{"bench", {0, 90, 180}};
inline constexpr ViewScene kFoliageView{"foliage", {0, 90, 180}};
inline constexpr ViewScene kFlowersView{"flowers", {0, 180, 90}};
inline constexpr ViewScene kColonnadeView{"colonnade", {0, 90, 180}};

/// A directional light's map around what the camera sees: a square, or as wide and high as that is seen from the light.
enum class MapFit : uint8_t { square, tight };

class ThesisView {
public:
    /// \param side of the picture, pixels.
    ThesisView(Device& device, const ViewScene& view, uint32_t side);

    /// From then on; the truth of a look is made once.
    void look(Look look);
    /// One frame by the method. Settings stay as they were given last, so callers give all that they ever change.
    Image8 draw(const std::string& method, const std::vector<SettingChoice>& settings);

    const Image8& truth() const { return seen_->truth; }
    /// countedPixels(): 1 counted, 2 grazing.
    const std::vector<uint8_t>& counted() const { return seen_->counted; }
    const Scene& scene() const { return scene_; }

    /// Texels per side that a map needs to be as fine as one of `side` texels that is fitted to what the camera sees:
    /// ours are fitted to the scene. Texels of equal area; at most 8192.
    uint32_t sideAsFitted(uint32_t side, MapFit fit);

private:
    struct Seen {
        Image8 truth;
        std::vector<uint8_t> counted;
        FrameSurfaces surfaces;
        CameraMatrices camera;
        double shares[2] = {}; ///< shareOfMap() by MapFit; 0: not known yet.
    };
    /// Side of the fitted map over ours, both as squares.
    double shareOfMap(const Seen& seen, MapFit fit) const;

    Scene scene_;
    ViewScene view_;
    Session session_;
    double time_ = 0.0;
    std::map<Look, Seen> looks_;
    Seen* seen_ = nullptr;
};

/// In percent; 0 of nothing.
double percentOf(uint64_t part, uint64_t whole);

} // namespace gnomon::demo
