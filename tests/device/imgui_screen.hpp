#pragma once
#include <functional>
#include <string>
#include <vector>

#include <imgui.h>

namespace gnomon::test {

/// ImGui without a backend: what it would draw is read back as text, and a mouse is moved and pressed. Spaces are not
/// drawn, so no text here has any.
class ImguiScreen {
public:
    struct Line {
        std::string text;
        std::vector<float> x; ///< Middle of each character, pixels.
        float y;              ///< Middle, pixels.
        int window;           ///< Windows are drawn in this order; the last one is on top.
    };

    /// \param draw Called once a frame of the screen.
    explicit ImguiScreen(std::function<void()> draw);
    ~ImguiScreen();
    ImguiScreen(const ImguiScreen&) = delete;
    ImguiScreen& operator=(const ImguiScreen&) = delete;

    /// As many frames as ImGui takes until sizes and pop-ups have settled.
    void settle();
    /// Top to bottom, then window by window, of the newest frame.
    const std::vector<Line>& lines() const noexcept { return lines_; }
    /// Of the topmost window, all lines in one.
    std::string top() const;
    /// The uppermost line that begins with a text, in the topmost window that has one; fails the test where there is
    /// none.
    const Line& lineWith(const std::string& beginning) const;
    /// Moves the mouse to a text in a line, and there presses and releases the button.
    void hover(const Line& line, const std::string& text);
    void click(const Line& line, const std::string& text);

private:
    void frame();
    void read(const ImDrawData& data);

    std::function<void()> draw_;
    ImGuiContext* context_;
    std::vector<Line> lines_;
};

/// As the screen shows it.
std::string withoutSpaces(const std::string& text);

} // namespace gnomon::test
