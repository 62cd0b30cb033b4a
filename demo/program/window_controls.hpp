#pragma once
// What the program adds to gnomon's panel: budget, rules, what the picture shows. In builds that have Dear ImGui.
#include "demo/program/window_rules.hpp"
#include "demo/program/window_settings.hpp"

namespace gnomon::demo {

class WindowControls {
public:
    /// Whether there is room beside gnomon's panel; else the window is a title above it until it is opened.
    /// \param scale of the display: 1 at 96 dots an inch.
    static bool standsBeside(float displayWidth, float scale);
    /// A window of ImGui, right in the display; it moves there where the display's size is another one.
    void draw(WindowSettings& settings, WindowRules& rules, float scale, bool resized);

private:
    void drawFloor(WindowRules& rules);

    float floor_ = 0.0f;   ///< Where its slider stands.
    uint32_t version_ = 0; ///< Of the rules that `floor_` was taken from.
};

} // namespace gnomon::demo
