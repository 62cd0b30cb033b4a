#include "device/imgui_screen.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include <doctest/doctest.h>

namespace gnomon::test {
namespace {

/// A character is a rectangle of four vertices; which one says the place of its picture in the font's texture.
const ImFontGlyph* glyphAt(const std::map<std::pair<float, float>, const ImFontGlyph*>& glyphs, const ImDrawVert* quad)
{
    const auto found = glyphs.find({quad[0].uv.x, quad[0].uv.y});
    if (found == glyphs.end()) return nullptr;
    const bool whole = quad[2].uv.x == found->second->U1 && quad[2].uv.y == found->second->V1;
    return whole ? found->second : nullptr;
}

} // namespace

ImguiScreen::ImguiScreen(std::function<void()> draw) : draw_(std::move(draw)), context_(ImGui::CreateContext())
{
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = nullptr; // nothing is kept from one run to the next
    io.DisplaySize = {1600.0f, 2000.0f};
    io.DeltaTime = 1.0f / 60.0f;
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height); // builds the font; there is no texture
    settle();
}

ImguiScreen::~ImguiScreen()
{
    ImGui::DestroyContext(context_);
}

void ImguiScreen::frame()
{
    ImGui::NewFrame();
    ImGui::SetNextWindowPos({0.0f, 0.0f});
    ImGui::SetNextWindowSize({1600.0f, 2000.0f});
    draw_();
    ImGui::Render();
    read(*ImGui::GetDrawData());
}

void ImguiScreen::settle()
{
    for (int i = 0; i < 4; ++i)
        frame();
}

void ImguiScreen::read(const ImDrawData& data)
{
    const ImFont& font = *ImGui::GetIO().Fonts->Fonts[0];
    std::map<std::pair<float, float>, const ImFontGlyph*> glyphs;
    for (const ImFontGlyph& glyph : font.Glyphs)
        if (glyph.Visible) glyphs[{glyph.U0, glyph.V0}] = &glyph;
    lines_.clear();
    for (int window = 0; window < data.CmdListsCount; ++window) {
        const ImDrawList& list = *data.CmdLists[window];
        std::map<int, std::map<float, char>> rows; // by the top of the text, then by place
        for (int i = 0; i + 3 < list.VtxBuffer.Size; ++i)
            if (const ImFontGlyph* glyph = glyphAt(glyphs, &list.VtxBuffer[i])) {
                const ImVec2 at = list.VtxBuffer[i].pos;
                const float middle = 0.5f * (at.x + list.VtxBuffer[i + 2].pos.x);
                rows[int(std::lround(at.y - glyph->Y0))][middle] = char(glyph->Codepoint);
                i += 3;
            }
        for (const auto& [y, characters] : rows) {
            Line line{.text = {}, .x = {}, .y = float(y) + 0.5f * font.FontSize, .window = window};
            for (const auto& [x, character] : characters) {
                line.text += character;
                line.x.push_back(x);
            }
            lines_.push_back(std::move(line));
        }
    }
}

std::string ImguiScreen::top() const
{
    std::string text;
    for (const Line& line : lines_)
        if (line.window == lines_.back().window) text += line.text;
    return text;
}

const ImguiScreen::Line& ImguiScreen::lineWith(const std::string& beginning) const
{
    const Line* found = nullptr;
    for (const Line& line : lines_)
        if (line.text.starts_with(beginning) && (!found || line.window > found->window)) found = &line;
    REQUIRE_MESSAGE(found, beginning);
    return *found;
}

void ImguiScreen::hover(const Line& line, const std::string& text)
{
    const size_t at = line.text.find(text);
    REQUIRE_MESSAGE(at != std::string::npos, text, " in ", line.text);
    ImGui::GetIO().MousePos = {line.x[at], line.y};
    settle();
}

void ImguiScreen::click(const Line& line, const std::string& text)
{
    hover(line, text);
    for (const bool down : {true, false}) {
        ImGui::GetIO().MouseDown[0] = down;
        frame();
    }
    settle();
}

std::string withoutSpaces(const std::string& text)
{
    std::string result;
    std::copy_if(text.begin(), text.end(), std::back_inserter(result),
                 [](char c) { return !std::isspace(static_cast<unsigned char>(c)); });
    return result;
}

} // namespace gnomon::test
