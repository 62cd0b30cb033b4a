/** \file gnomon_imgui.h
\brief A panel for Dear ImGui (1.84 or later): which light has which method, why, when it changed, and what it takes;
methods are pinned by hand. Header-only, C++17, over the C API alone. The host owns ImGui's context, its backend and the
font.

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
#include <cmath>
#include <cstdio>
#include <deque>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

namespace gnomon {

/// A light of the view's last frame, and what the host calls it. The name is read during the call.
struct ImguiLight {
    GnLight light;
    const char* pName;
};

/// A term of a fact, as rules have it: 0 outside [a, d], 1 on [b, c], a <= b <= c <= d; corners may be infinite.
struct ImguiTerm {
    std::string name;
    double a, b, c, d;
    double membership(double x) const noexcept
    {
        if (!(x >= a && x <= d)) return 0.0;
        if (x < b) return (x - a) / (b - a);
        return x > c ? (d - x) / (d - c) : 1.0;
    }
};

/// A fact with its terms. Facts outside [low, high] count as the nearest edge.
struct ImguiVariable {
    std::string name; ///< As GnFact::pName.
    double low, high; ///< In the fact's unit; low < high.
    std::vector<ImguiTerm> terms;
};

class ImguiPanel {
public:
    /// Terms to draw the facts with; the host takes them from its rule base. Without, facts are numbers alone.
    void setVariables(std::vector<ImguiVariable> variables) { variables_ = std::move(variables); }

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
                drawLights(pLights, lightCount, stats.frame);
                if (!failure_.empty()) ImGui::TextColored(ImVec4(1.0f, 0.4f, 0.4f, 1.0f), "%s", failure_.c_str());
                drawSwitches(stats.frame);
                drawFacts(pLights[selected_]);
                drawMethods(pLights[selected_]);
                drawRules(pLights[selected_]);
            }
        }
        ImGui::End();
    }

    /// Whose methods and rules are shown: an index into the last call's lights.
    uint32_t selected() const noexcept { return selected_; }

private:
    static constexpr int kHistory = 240;           // frames of the graph
    static constexpr uint64_t kSwitchFrames = 240; // frames of the timeline
    static constexpr uint32_t kShownLights = 8;    // rows; more of them scroll
    static constexpr size_t kMaxSwitches = 1024, kListedSwitches = 4;

    struct Row { // what was asked about a light, until its decision changes
        GnLight light = VK_NULL_HANDLE;
        const char* pMethod = nullptr;
        GnReason reason = GN_REASON_MAX_ENUM;
        uint32_t mapSide = 0;
        float quality = 0.0f; // of the method; 0: unknown
        std::string why;
    };

    struct Served { // what served a light when it was last seen
        GnLight light;
        const char* pMethod;
    };

    struct Switch {
        uint64_t frame;
        std::string light, why;
        const char *pFrom, *pTo;
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

    void drawLights(const ImguiLight* pLights, uint32_t lightCount, uint64_t frame)
    {
        constexpr ImGuiTableFlags flags = ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerV |
                                          ImGuiTableFlags_Resizable | ImGuiTableFlags_SizingFixedFit;
        const bool scrolls = lightCount > kShownLights;
        const float height = scrolls ? float(kShownLights) * ImGui::GetFrameHeightWithSpacing() : 0.0f;
        if (!ImGui::BeginTable("lights", 8, scrolls ? flags | ImGuiTableFlags_ScrollY : flags, ImVec2(0.0f, height)))
            return;
        if (scrolls) ImGui::TableSetupScrollFreeze(0, 1);
        for (const char* column : {"light", "method", "map", "cadence", "predicted ms", "measured ms", "error %"})
            ImGui::TableSetupColumn(column);
        ImGui::TableSetupColumn("why", ImGuiTableColumnFlags_WidthStretch);
        ImGui::TableHeadersRow();
        sum_ = {};
        for (uint32_t i = 0; i < lightCount; ++i) {
            ImGui::PushID(int(i));
            drawLight(pLights[i], i, frame);
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

    void drawLight(const ImguiLight& light, uint32_t index, uint64_t frame)
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
        Row& row = rows_[index];
        if (row.light != light.light || row.pMethod != decision.pMethod || row.reason != decision.reason ||
            row.mapSide != decision.mapSide)
            row = {light.light,      decision.pMethod,           decision.reason,
                   decision.mapSide, qualityOf(light, decision), firstReason(light)};
        number(row.quality > 0.0f, "%.2f", 1.0 / double(row.quality) - 1.0); // quality is 1 / (1 + wrong per cent)
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("pixels expected to be wrong, in per cent");
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(row.why.c_str());
        if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", row.why.c_str()); // the column may cut it
        noteSwitch(light, decision, row.why, frame);
    }

    float qualityOf(const ImguiLight& light, const GnDecision& decision) const
    {
        for (const GnCandidate& candidate : candidates(light))
            if (candidate.pMethod == decision.pMethod) return candidate.quality;
        return 0.0f;
    }

    void noteSwitch(const ImguiLight& light, const GnDecision& decision, const std::string& why, uint64_t frame)
    {
        const auto served = std::find_if(served_.begin(), served_.end(),
                                         [&](const Served& known) { return known.light == light.light; });
        if (served == served_.end()) {
            served_.push_back({light.light, decision.pMethod});
        } else if (served->pMethod != decision.pMethod) {
            const std::string reason = why.substr(0, why.find("; was ")); // the event names both methods
            switches_.push_back({frame, light.pName, reason, served->pMethod, decision.pMethod});
            if (switches_.size() > kMaxSwitches) switches_.pop_front();
            served->pMethod = decision.pMethod;
        }
    }

    static std::string textOf(const Switch& event)
    {
        const auto name = [](const char* pMethod) { return std::string(pMethod ? pMethod : "none"); };
        return "frame " + std::to_string(event.frame) + "  " + event.light + ": " + name(event.pFrom) + " -> " +
               name(event.pTo) + ", " + event.why;
    }

    /// The methods' changes while the panel was drawn: newest at the right, each under the mouse in words, and the
    /// newest ones as a list.
    void drawSwitches(uint64_t frame)
    {
        if (!ImGui::CollapsingHeader("switches", ImGuiTreeNodeFlags_DefaultOpen)) return;
        const Strip strip = drawStrip("##switches", 2.0f);
        std::string hovered;
        for (const Switch& event : switches_) {
            if (event.frame + kSwitchFrames < frame || event.frame > frame) continue;
            const float age = float(frame - event.frame) / float(kSwitchFrames);
            const float x = strip.high.x - age * (strip.high.x - strip.low.x);
            strip.list->AddLine(ImVec2(x, strip.low.y), ImVec2(x, strip.high.y), ImGui::GetColorU32(ImGuiCol_PlotLines),
                                2.0f);
            if (strip.hovered && std::fabs(ImGui::GetIO().MousePos.x - x) <= 0.3f * ImGui::GetFontSize()) {
                if (!hovered.empty()) hovered += '\n';
                hovered += textOf(event);
            }
        }
        if (!hovered.empty()) ImGui::SetTooltip("%s", hovered.c_str());
        for (size_t i = 0; i < std::min(kListedSwitches, switches_.size()); ++i)
            ImGui::TextUnformatted(textOf(switches_[switches_.size() - 1 - i]).c_str());
        if (switches_.empty()) ImGui::TextDisabled("no light has changed its method yet");
    }

    struct Strip { // a plain field that is drawn into
        ImDrawList* list;
        ImVec2 low, high;
        bool hovered;
    };

    static Strip drawStrip(const char* id, float lines)
    {
        ImGui::InvisibleButton(id, ImVec2(std::max(ImGui::GetContentRegionAvail().x, 1.0f),
                                          lines * ImGui::GetTextLineHeightWithSpacing()));
        const Strip strip{ImGui::GetWindowDrawList(), ImGui::GetItemRectMin(), ImGui::GetItemRectMax(),
                          ImGui::IsItemHovered()};
        strip.list->AddRectFilled(strip.low, strip.high, ImGui::GetColorU32(ImGuiCol_FrameBg));
        return strip;
    }

    /// One fact of the selected light by choice, with the shapes of its terms and a line where it is now.
    void drawFacts(const ImguiLight& light)
    {
        if (!ImGui::CollapsingHeader("facts", ImGuiTreeNodeFlags_DefaultOpen)) return;
        uint32_t count = 0;
        gnGetFacts(context_, view_, light.light, &count, nullptr);
        facts_.resize(count);
        if (count == 0 || gnGetFacts(context_, view_, light.light, &count, facts_.data()) < 0) return;
        fact_ = std::min(fact_, count - 1);
        ImGui::SetNextItemWidth(14.0f * ImGui::GetFontSize());
        if (ImGui::BeginCombo("##fact", facts_[fact_].pName, ImGuiComboFlags_HeightLarge)) {
            for (uint32_t i = 0; i < count; ++i)
                if (ImGui::Selectable(facts_[i].pName, i == fact_)) fact_ = i;
            ImGui::EndCombo();
        }
        const GnFact& fact = facts_[fact_];
        ImGui::SameLine();
        if (std::isnan(fact.value))
            ImGui::Text("of %s is unknown", light.pName);
        else
            ImGui::Text("of %s is %.3g %s", light.pName, fact.value, fact.pUnit);
        for (const ImguiVariable& variable : variables_)
            if (variable.name == fact.pName) drawTerms(variable, fact.value);
    }

    static void drawTerms(const ImguiVariable& variable, double value)
    {
        const Strip strip = drawStrip("##terms", 4.0f);
        const ImVec2 low = strip.low, high = strip.high;
        const auto at = [&](double x) {
            const double share = std::clamp((x - variable.low) / (variable.high - variable.low), 0.0, 1.0);
            return low.x + float(share) * (high.x - low.x);
        };
        const auto height = [&](double membership) { return high.y - float(membership) * 0.9f * (high.y - low.y); };
        const double known = std::clamp(value, variable.low, variable.high); // NaN stays
        for (size_t i = 0; i < variable.terms.size(); ++i) {
            const ImguiTerm& term = variable.terms[i];
            const ImU32 colour = ImColor::HSV(float(i) / float(variable.terms.size()), 0.5f, 1.0f);
            std::vector<ImVec2> line{ImVec2(low.x, height(term.membership(variable.low)))};
            for (const auto& [x, membership] :
                 {std::pair<double, double>(term.a, 0.0), {term.b, 1.0}, {term.c, 1.0}, {term.d, 0.0}})
                if (x >= variable.low && x <= variable.high) line.push_back(ImVec2(at(x), height(membership)));
            line.push_back(ImVec2(high.x, height(term.membership(variable.high))));
            strip.list->AddPolyline(line.data(), int(line.size()), colour, 0, 2.0f);
            if (std::isnan(value)) continue;
            if (i != 0) ImGui::SameLine();
            ImGui::TextColored(ImColor(colour), "%s %.2f", term.name.c_str(), term.membership(known));
        }
        if (!std::isnan(value))
            strip.list->AddLine(ImVec2(at(known), low.y), ImVec2(at(known), high.y), IM_COL32_WHITE, 2.0f);
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
        ImGui::SetNextItemWidth(12.0f * ImGui::GetFontSize());
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
        static constexpr const char* words[] = {
            "chosen",          "cannot serve",         "not ready",       "another one is pinned", "vetoed",
            "no rule speaks",  "below the near floor", "over the budget", "held back",             "suits less",
            "takes longer for no more"};
        static_assert(std::size(words) == GN_ELIMINATION_PRICE + 1);
        return size_t(elimination) < std::size(words) ? words[elimination] : "unknown to this header";
    }

    GnContext context_ = nullptr;
    GnView view_ = VK_NULL_HANDLE;
    uint32_t selected_ = 0;
    uint64_t timedFrame_ = 0;
    std::vector<float> times_; // milliseconds, newest last
    std::vector<Row> rows_;    // one per light
    std::vector<Served> served_;
    std::deque<Switch> switches_; // newest last
    std::vector<ImguiVariable> variables_;
    std::vector<GnFact> facts_;
    uint32_t fact_ = 0; // the selected one
    Sum sum_;
    std::string failure_; // of the last pin
};

} // namespace gnomon
#endif /* GNOMON_GNOMON_IMGUI_H */
