#pragma once
// gnomon's panel (gnomon_imgui.h) and the program's controls over a window's picture, in builds that have Dear ImGui.
#include <memory>

#include "demo/host/window.hpp"
#include "demo/program/session.hpp"
#include "demo/program/window_rules.hpp"
#include "demo/program/window_settings.hpp"

namespace gnomon::demo {

class WindowPanel {
public:
    /// All outlive it.
    WindowPanel(Session& session, const Window& window, uint32_t framesInFlight, WindowSettings& settings,
                WindowRules& rules);
    ~WindowPanel();
    WindowPanel(const WindowPanel&) = delete;
    WindowPanel& operator=(const WindowPanel&) = delete;

    /// Draws over a picture that is in TRANSFER_SRC_OPTIMAL before and after; in every frame once.
    void draw(VkCommandBuffer cmd, const Image& picture);

    // By the newest drawing: what is typed or pressed is for the panel.
    bool wantsKeys() const;
    bool wantsMouse() const;

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace gnomon::demo
