#pragma once
// Shadows of the first centimetres of contact, from the depth image alone: what maps of few texels lose there.
#include "runtime/algorithm.hpp"

namespace gnomon {

class ContactShadows {
public:
    explicit ContactShadows(const AlgorithmServices& services);

    /// Darkens the task's layer of visibility, which has been written. @param lengthWs of the rays, metres; 0: nothing
    void declare(PassBuilder& passes, const ShadowTask& task, double lengthWs) const;

private:
    PipelineId march_[2]; ///< [has normals]
};

inline constexpr SettingSpec kContactSetting = {
    "contact", "Metres towards the light in which what the depth image shows casts shadows, too. 0: none.", 0, 1, 0};

} // namespace gnomon
