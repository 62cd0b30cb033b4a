#pragma once
// gnomon's panel (gnomon_imgui.h) over the picture of `gnomon run --window`, in builds that have Dear ImGui.
#include <memory>

#include "demo/host/window.hpp"
#include "demo/program/session.hpp"

namespace gnomon::demo {

class WindowPanel {
public:
    WindowPanel(Session& session, const Window& window, uint32_t framesInFlight);
    ~WindowPanel();
    WindowPanel(const WindowPanel&) = delete;
    WindowPanel& operator=(const WindowPanel&) = delete;

    /// Draws over a picture that is in TRANSFER_SRC_OPTIMAL before and after; in every frame once.
    void draw(VkCommandBuffer cmd, const Image& picture);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace gnomon::demo
