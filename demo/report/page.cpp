#include "demo/report/page.hpp"

#include "demo/report/markup.hpp"

namespace gnomon::demo {

namespace {

constexpr std::string_view kStyle = R"css(
body{font:15px/1.45 system-ui,sans-serif;color:#1c2128;background:#f4f5f7;margin:0}
main{max-width:1080px;margin:0 auto;padding:16px}
section{background:#fff;border:1px solid #d8dce2;border-radius:6px;padding:14px 20px;margin:0 0 16px}
h1{font-size:26px;margin:4px 0 10px}h2{font-size:19px;margin:2px 0 8px}h3{font-size:15px;margin:14px 0 4px}
table{border-collapse:collapse;margin:6px 0}th,td{padding:2px 12px 2px 0;text-align:left;vertical-align:top}
th{font-weight:600}td{font-variant-numeric:tabular-nums}
.headline{font-size:17px}.note{color:#59636e;font-size:13px}
pre{background:#f4f5f7;padding:8px 10px;overflow-x:auto;font-size:13px;white-space:pre-wrap}
svg{display:block;width:100%;height:auto}
.grid{stroke:#e3e6ea;fill:none}.tick{font-size:11px;fill:#59636e}.axis{font-size:12px;fill:#1c2128}
.row{font-size:9px;fill:#1c2128}svg rect{shape-rendering:crispEdges}
.tip{fill:#000;fill-opacity:0}.tip:hover{fill-opacity:.08}rect:hover{stroke:#000;stroke-width:.6}
.legend span{margin-right:14px;white-space:nowrap}
.legend i{display:inline-block;width:13px;height:13px;margin-right:5px;vertical-align:-2px;border-radius:2px}
.charts{display:flex;flex-wrap:wrap}.charts figure{width:500px;margin:6px 8px}
.bands{width:100%}.bands th{white-space:nowrap}.bar{width:80%;white-space:nowrap;overflow:hidden}
.bar span{display:inline-block;height:18px;vertical-align:middle}
figure{margin:10px 0}figcaption{color:#59636e;font-size:13px}
.slide{position:relative;display:inline-block;--cut:50%}.slide img{display:block;max-width:100%}
.slide .over{position:absolute;left:0;top:0;clip-path:inset(0 calc(100% - var(--cut)) 0 0)}
.slide input{position:absolute;left:0;bottom:4px;width:100%;margin:0}
@media print{body{background:#fff}section{break-inside:avoid;border:0;padding:0}.slide input{display:none}
.bar span,.legend i{print-color-adjust:exact;-webkit-print-color-adjust:exact}}
)css";

} // namespace

std::string page(std::string_view title, std::string_view body)
{
    std::string out = "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\"><head>"
                      "<meta charset=\"utf-8\"/><meta name=\"viewport\" content=\"width=device-width\"/>"
                      "<link rel=\"icon\" href=\"data:,\"/><title>";
    out += escaped(title);
    out += "</title><style>";
    out += kStyle;
    out += "</style></head><body><main>\n";
    out += body;
    return out + "</main></body></html>\n";
}

} // namespace gnomon::demo
