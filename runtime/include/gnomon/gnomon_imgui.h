/** \file gnomon_imgui.h
\brief A panel for Dear ImGui (1.84 or later): which light has which method, why, and what it takes; methods are pinned
by hand. Header-only, C++17, over the C API alone. The host owns ImGui's context, its backend and the font.

    gnomon::ImguiPanel panel;                                   // one per view, as long as the view lives
    ...
    ImGui::NewFrame();
    const gnomon::ImguiLight lights[] = {{sun, "sun"}, {lamp, "lamp"}};
    panel.draw(context, view, lights, 2);                       // after gnomon's frame
    ImGui::Render();

Answers to *why* and *why not* are gnExplain()'s.
*/
#ifndef GNOMON_GNOMON_IMGUI_H
#define GNOMON_GNOMON_IMGUI_H

#include <gnomon/gnomon.h>
#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cstdio>
#include <string>
#include <vector>

namespace gnomon {

/// A light of the view's last frame, and what the host calls it. The name is read during the call.
struct ImguiLight {
    GnLight light;
    const char* pName;
};

class ImguiPanel {
public:
    /// One window of ImGui. Called where gnomon may be called, between ImGui::NewFrame() and ImGui::Render(); not
    /// between gnBeginShadows() and gnFinishShadows(). \param pLights Lights of the view's last frame; of others the
    /// row says that they are in none, and gnomon reports it as a message.
    void draw(GnContext context, GnView view, const ImguiLight* pLights, uint32_t lightCount,
              const char* title = "gnomon")
    {
        context_ = context;
        view_ = view;
        if (ImGui::Begin(title)) {
            GnFrameStats stats{};
            gnGetFrameStats(context, &stats);
            drawTimes(stats);
            if (stats.frame != 0 && lightCount != 0) {
                rows_.resize(lightCount);
                selected_ = std::min(selected_, lightCount - 1);
                drawLights(pLights, lightCount);
                if (!failure_.empty()) ImGui::TextColored(ImVec4(1.0f, 0.4f, 0.4f, 1.0f), "%s", failure_.c_str());
                drawMethods(pLights[selected_]);
                drawRules(pLights[selected_]);
            }
        }
        ImGui::End();
    }

    /// Whose methods and rules are shown: an index into the last call's lights.
    uint32_t selected() const noexcept { return selected_; }

private:
    static constexpr int kHistory = 240; // frames

    struct Row { // what was asked about a light, until its decision changes
        GnLight light = VK_NULL_HANDLE;
        const char* pMethod = nullptr;
        GnReason reason = GN_REASON_MAX_ENUM;
        std::string why;
    };

    struct Sum { // of the lights in the table
        float predictedMs = 0.0f, measuredMs = 0.0f;
        bool known = true; // all of them have been timed
    };

    /// Of all views of the context, on the GPU and the CPU, as a budget counts them, in frames that are completed. The
    /// tables are about one view: their sum is less where there are others, and by what views and lights share.
    void drawTimes(const GnFrameStats& stats)
    {
        if (stats.gpuFrame != timedFrame_) {
            timedFrame_ = stats.gpuFrame;
            times_.push_back(stats.gpuMs + stats.gpuFrameCpuMs);
            if (times_.size() > kHistory) times_.erase(times_.begin());
        }
        const float newest = times_.empty() ? 0.0f : times_.back();
        float top = std::max(stats.budgetMs, 0.01f);
        for (const float ms : times_)
            top = std::max(top, ms);
        top *= 1.1f;
        char text[64];
        if (stats.budgetMs > 0.0f)
            std::snprintf(text, sizeof text, "all views: %.2f ms of %.2f ms", double(newest), double(stats.budgetMs));
        else
            std::snprintf(text, sizeof text, "all views: %.2f ms, no budget", double(newest));
        const float width = std::max(ImGui::GetContentRegionAvail().x, 1.0f);
        ImGui::PlotLines("##times", times_.data(), int(times_.size()), 0, text, 0.0f, top,
                         ImVec2(width, 5.0f * ImGui::GetFontSize()));
        if (stats.budgetMs > 0.0f) {
            const ImVec2 low = ImGui::GetItemRectMin(), high = ImGui::GetItemRectMax();
            const float y = high.y - (high.y - low.y) * stats.budgetMs / top;
            ImGui::GetWindowDrawList()->AddLine(ImVec2(low.x, y), ImVec2(high.x, y), IM_COL32(255, 170, 60, 255));
        }
        ImGui::Text("all views: predicted %.2f ms, %.1f MiB, %u of the lights changed", double(stats.predictedMs),
                    double(stats.memory) / (1024.0 * 1024.0), stats.switches);
    }

    void drawLights(const ImguiLight* pLights, uint32_t lightCount)
    {
        constexpr ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                          ImGuiTableFlags_Resizable | ImGuiTableFlags_SizingFixedFit;
        if (!ImGui::BeginTable("lights", 7, flags)) return;
        for (const char* column : {"light", "method", "map", "drawn every", "predicted ms", "measured ms"})
            ImGui::TableSetupColumn(column);
        ImGui::TableSetupColumn("why", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableHeadersRow();
        sum_ = {};
        for (uint32_t i = 0; i < lightCount; ++i) {
            ImGui::PushID(int(i));
            drawLight(pLights[i], i);
            ImGui::PopID();
        }
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextDisabled("this view");
        ImGui::TableSetColumnIndex(3);
        number(true, "%.2f", double(sum_.predictedMs));
        number(sum_.known, "%.2f", double(sum_.measuredMs));
        ImGui::EndTable();
    }

    void drawLight(const ImguiLight& light, uint32_t index)
    {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::AlignTextToFramePadding(); // the row's texts stand at the height of the combo box's
        if (ImGui::Selectable(light.pName, index == selected_)) selected_ = index;
        GnDecision decision{};
        ImGui::TableNextColumn();
        if (gnGetDecision(context_, view_, light.light, &decision) < 0) {
            ImGui::TextDisabled("not in the last frame");
            return;
        }
        drawPin(light, decision);
        number(decision.mapSide != 0, "%u", decision.mapSide);
        number(decision.redrawEvery != 0, "%u", decision.redrawEvery);
        number(decision.pMethod != nullptr, "%.2f", double(decision.predictedMs));
        number(decision.measuredMs > 0.0f, "%.2f", double(decision.measuredMs));
        sum_.predictedMs += decision.predictedMs;
        sum_.measuredMs += decision.measuredMs;
        sum_.known = sum_.known && (decision.measuredMs > 0.0f || !decision.pMethod);
        ImGui::TableNextColumn();
        Row& row = rows_[index];
        if (row.light != light.light || row.pMethod != decision.pMethod || row.reason != decision.reason)
            row = {light.light, decision.pMethod, decision.reason, firstReason(light)};
        ImGui::TextUnformatted(row.why.c_str());
    }

    template <typename Number>
    static void number(bool known, const char* format, Number value)
    {
        ImGui::TableNextColumn();
        if (known)
            ImGui::Text(format, value);
        else
            ImGui::TextDisabled("-");
    }

    /// All methods; those that cannot serve the light are grey, and say why when they are chosen.
    void drawPin(const ImguiLight& light, const GnDecision& decision)
    {
        const bool pinned = decision.reason == GN_REASON_PINNED || decision.reason == GN_REASON_NOT_RECORDABLE;
        std::string shown = decision.pMethod ? decision.pMethod : "none";
        if (decision.reason == GN_REASON_PINNED) shown += " (pinned)";
        ImGui::SetNextItemWidth(14.0f * ImGui::GetFontSize());
        if (!ImGui::BeginCombo("##method", shown.c_str(), ImGuiComboFlags_HeightLarge)) return;
        if (ImGui::Selectable("by the rules", !pinned)) pin(light, nullptr);
        for (const GnCandidate& candidate : candidates(light)) {
            const bool unable = candidate.elimination == GN_ELIMINATION_UNABLE;
            if (unable) ImGui::PushStyleColor(ImGuiCol_Text, ImGui::GetStyleColorVec4(ImGuiCol_TextDisabled));
            const bool serves = decision.pMethod == candidate.pMethod;
            if (ImGui::Selectable(candidate.pMethod, pinned && serves)) pin(light, candidate.pMethod);
            if (unable) ImGui::PopStyleColor();
            whyNotOnHover(light, candidate);
        }
        ImGui::EndCombo();
    }

    void pin(const ImguiLight& light, const char* pMethod)
    {
        const GnResult result = gnSetLightMethod(context_, light.light, pMethod);
        failure_ = result < 0 ? std::string(light.pName) + ": " + gnGetLastError(context_) : std::string();
    }

    /// The candidates of the selected light as its last decision saw them.
    void drawMethods(const ImguiLight& light)
    {
        ImGui::Separator();
        ImGui::Text("methods for %s", light.pName);
        if (!ImGui::BeginTable("methods", 5, ImGuiTableFlags_RowBg | ImGuiTableFlags_SizingFixedFit)) return;
        for (const char* column : {"method", "suitability", "quality", "predicted ms", "outcome"})
            ImGui::TableSetupColumn(column);
        ImGui::TableHeadersRow();
        for (const GnCandidate& candidate : candidates(light)) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::Selectable(candidate.pMethod, candidate.elimination == GN_ELIMINATION_NONE,
                              ImGuiSelectableFlags_SpanAllColumns);
            whyNotOnHover(light, candidate);
            ImGui::TableNextColumn();
            const ImVec2 bar(7.0f * ImGui::GetFontSize(), ImGui::GetTextLineHeight());
            if (candidate.suitability >= 0)
                ImGui::ProgressBar(float(candidate.suitability) / GN_SUITABILITY_STEPS, bar);
            else
                ImGui::Dummy(bar);
            number(candidate.quality > 0.0f, "%.3f", double(candidate.quality));
            number(candidate.predictedMs > 0.0f, "%.2f", double(candidate.predictedMs));
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(outcome(candidate.elimination));
        }
        ImGui::EndTable();
    }

    /// Why the selected light has its method; a rule's strength is drawn as a bar beside its line.
    void drawRules(const ImguiLight& light)
    {
        ImGui::Separator();
        ImGui::Text("rules for %s", light.pName);
        const std::string text = ask(light, GN_QUESTION_WHY, nullptr);
        ImGui::PushTextWrapPos(0.0f);
        for (size_t begin = 0; begin < text.size();) {
            const size_t end = std::min(text.find('\n', begin), text.size());
            const std::string line = text.substr(begin, end - begin);
            float strength = 0.0f;
            if (const size_t at = line.rfind("-> strength "); at != std::string::npos)
                if (std::sscanf(line.c_str() + at, "-> strength %f", &strength) == 1) {
                    const ImVec2 bar(7.0f * ImGui::GetFontSize(), ImGui::GetTextLineHeight());
                    ImGui::ProgressBar(strength, bar);
                    ImGui::SameLine();
                }
            ImGui::TextUnformatted(line.c_str());
            begin = end + 1;
        }
        ImGui::PopTextWrapPos();
    }

    void whyNotOnHover(const ImguiLight& light, const GnCandidate& candidate) const
    {
        if (!ImGui::IsItemHovered()) return;
        const bool chosen = candidate.elimination == GN_ELIMINATION_NONE;
        const std::string text =
            ask(light, chosen ? GN_QUESTION_WHY : GN_QUESTION_WHY_NOT, chosen ? nullptr : candidate.pMethod);
        ImGui::BeginTooltip();
        ImGui::PushTextWrapPos(40.0f * ImGui::GetFontSize());
        ImGui::TextUnformatted(text.c_str());
        ImGui::PopTextWrapPos();
        ImGui::EndTooltip();
    }

    std::vector<GnCandidate> candidates(const ImguiLight& light) const
    {
        uint32_t count = 0;
        if (gnGetCandidates(context_, view_, light.light, &count, nullptr) < 0) return {};
        std::vector<GnCandidate> result(count);
        if (gnGetCandidates(context_, view_, light.light, &count, result.data()) < 0) return {};
        return result;
    }

    std::string ask(const ImguiLight& light, GnQuestionKind kind, const char* pMethod) const
    {
        GnQuestion question{};
        question.kind = kind;
        question.pMethod = pMethod;
        size_t size = 0;
        if (gnExplain(context_, view_, light.light, &question, &size, nullptr) < 0) return gnGetLastError(context_);
        std::string text(size, '\0');
        if (gnExplain(context_, view_, light.light, &question, &size, text.data()) < 0) return gnGetLastError(context_);
        while (!text.empty() && (text.back() == '\0' || text.back() == '\n'))
            text.pop_back();
        return text;
    }

    /// "light 'sun', frame 12: METHOD at 512, highest suitability": what stands after the method.
    std::string firstReason(const ImguiLight& light) const
    {
        std::string line = ask(light, GN_QUESTION_WHY, nullptr);
        line.resize(std::min(line.find('\n'), line.size()));
        const size_t frame = line.rfind("', frame ");
        const size_t method = frame == std::string::npos ? frame : line.find(": ", frame);
        const size_t reason = method == std::string::npos ? method : line.find(", ", method);
        return reason == std::string::npos ? line : line.substr(reason + 2);
    }

    static const char* outcome(GnElimination elimination)
    {
        switch (elimination) {
        case GN_ELIMINATION_NONE:
            return "chosen";
        case GN_ELIMINATION_UNABLE:
            return "cannot serve";
        case GN_ELIMINATION_NOT_READY:
            return "not ready";
        case GN_ELIMINATION_PINNED:
            return "another one is pinned";
        case GN_ELIMINATION_NEVER:
            return "vetoed";
        case GN_ELIMINATION_NO_OPINION:
            return "no rule speaks";
        case GN_ELIMINATION_FLOOR:
            return "below the near floor";
        case GN_ELIMINATION_BUDGET:
            return "over the budget";
        case GN_ELIMINATION_HYSTERESIS:
            return "held back";
        case GN_ELIMINATION_OUTSCORED:
            return "suits less";
        case GN_ELIMINATION_PRICE:
            return "takes longer for no more";
        case GN_ELIMINATION_MAX_ENUM:
            break;
        }
        return "unknown to this header";
    }

    GnContext context_ = nullptr;
    GnView view_ = VK_NULL_HANDLE;
    uint32_t selected_ = 0;
    uint64_t timedFrame_ = 0;
    std::vector<float> times_; // milliseconds, newest last
    std::vector<Row> rows_;    // one per light
    Sum sum_;
    std::string failure_; // of the last pin
};

} // namespace gnomon
#endif /* GNOMON_GNOMON_IMGUI_H */
