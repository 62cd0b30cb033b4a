#include "demo/program/window_controls.hpp"

#include <imgui.h>

namespace gnomon::demo {
namespace {

constexpr float kWidth = 350.0f, kMargin = 10.0f; // pixels at 96 dots an inch
constexpr float kPanelsWidth = 840.0f;            // of gnomon's panel
constexpr float kMostBudgetMs = 1000.0f;          // a software device's
const ImVec4 kRed(1.0f, 0.4f, 0.4f, 1.0f), kYellow(1.0f, 0.85f, 0.4f, 1.0f);

/// Tab selects lights; ImGui would take it to edit the next slider.
void setTabStops(bool are)
{
#if IMGUI_VERSION_NUM < 18940
    ImGui::PushAllowKeyboardFocus(are);
#else
    ImGui::PushTabStop(are);
#endif
}
void resetTabStops()
{
#if IMGUI_VERSION_NUM < 18940
    ImGui::PopAllowKeyboardFocus();
#else
    ImGui::PopTabStop();
#endif
}

void drawBudget(float& budgetMs)
{
    ImGui::SliderFloat("budget", &budgetMs, 0.0f, kMostBudgetMs, budgetMs > 0.0f ? "%.1f ms" : "by the rules",
                       ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
}

void drawRules(WindowRules& rules)
{
    if (ImGui::BeginCombo("rules", rules.inForce().c_str(), ImGuiComboFlags_HeightLarge)) {
        const std::string* chosen = nullptr;
        for (const std::string& name : rules.names())
            if (ImGui::Selectable(name.c_str(), name == rules.inForce())) chosen = &name;
        ImGui::EndCombo();
        if (chosen) rules.choose(*chosen);
    }
    if (!rules.fault().empty()) {
        ImGui::TextColored(kRed, "%s", rules.fault().c_str());
        ImGui::TextUnformatted("the last good rules stay in force");
    }
    if (rules.base() && rules.findings().empty()) ImGui::TextDisabled("lint finds nothing");
    for (const std::string& finding : rules.findings())
        ImGui::TextColored(kYellow, "%s", finding.c_str());
}

void drawPicture(WindowSettings& settings)
{
    const auto tint = [&](const char* label, Tint wanted) {
        if (ImGui::RadioButton(label, settings.tint == wanted)) settings.tint = wanted;
    };
    ImGui::TextUnformatted("lights' colours");
    tint("their own", Tint::none);
    ImGui::SameLine();
    tint("method", Tint::method);
    ImGui::SameLine();
    tint("cadence", Tint::cadence);
    ImGui::Checkbox("split: right of the line by ray_traced", &settings.split);
    if (settings.split) {
        ImGui::Checkbox("errors against it in place of its picture", &settings.errors);
        if (settings.wrongPercent) ImGui::Text("right of the line %.3f %% are wrong", *settings.wrongPercent);
    }
    ImGui::Checkbox("texels of the selected light's map", &settings.texels);
    for (const WindowSettings::LegendLine& line : settings.legend) {
        const ImVec4 colour(float(line.colour.r) / 255.0f, float(line.colour.g) / 255.0f, float(line.colour.b) / 255.0f,
                            1.0f);
        ImGui::ColorButton(line.text.c_str(), colour, ImGuiColorEditFlags_NoTooltip,
                           ImVec2(ImGui::GetTextLineHeight(), ImGui::GetTextLineHeight()));
        ImGui::SameLine();
        ImGui::TextUnformatted(line.text.c_str());
    }
    ImGui::Checkbox("record", &settings.recording);
    if (!settings.notice.empty()) ImGui::TextUnformatted(settings.notice.c_str());
}

} // namespace

bool WindowControls::standsBeside(float displayWidth, float scale)
{
    return displayWidth >= (kPanelsWidth + kWidth + 3.0f * kMargin) * scale;
}

void WindowControls::drawFloor(WindowRules& rules)
{
    if (!rules.base() || rules.base()->policy.floor.when.empty()) return;
    if (version_ != rules.version()) floor_ = static_cast<float>(rules.base()->policy.floor.minimumQuality);
    version_ = rules.version();
    ImGui::SliderFloat("near floor", &floor_, 0.0f, 1.0f, "quality %.3f", ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemDeactivatedAfterEdit()) rules.setFloorQuality(double{floor_}); // once: it reads the rules again
    if (ImGui::IsItemHovered() && floor_ > 0.0f)
        ImGui::SetTooltip("near the eye at most %.2g %% of the pixels wrong", 1.0 / double{floor_} - 1.0);
}

void WindowControls::draw(WindowSettings& settings, WindowRules& rules, float scale, bool resized)
{
    const ImGuiCond when = resized ? ImGuiCond_Always : ImGuiCond_FirstUseEver;
    const ImVec2 whole = ImGui::GetIO().DisplaySize;
    const float width = kWidth * scale, margin = kMargin * scale;
    ImGui::SetNextWindowPos({whole.x - margin, margin}, when, {1.0f, 0.0f});
    ImGui::SetNextWindowSizeConstraints({width, 0.0f}, {width, 0.9f * whole.y});
    ImGui::SetNextWindowCollapsed(!standsBeside(whole.x, scale), when);
    if (ImGui::Begin("controls", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoFocusOnAppearing)) {
        ImGui::PushItemWidth(0.62f * width);
        ImGui::PushTextWrapPos(width - margin);
        setTabStops(false);
        drawBudget(settings.budgetMs);
        drawFloor(rules);
        drawRules(rules);
        ImGui::Separator();
        drawPicture(settings);
        resetTabStops();
        ImGui::PopTextWrapPos();
        ImGui::PopItemWidth();
    }
    ImGui::End();
}

} // namespace gnomon::demo
