#include "server/ui/landing_page.h"

namespace graspdb {

std::string MakeLandingPage(const std::vector<Operation>& operations) {
  std::string rows;
  for (const auto& [method, path] : operations) {
    const bool linked = method == "GET" && path.find('{') == std::string::npos;
    rows += "<tr><td>" + method + "</td><td>" +
            (linked ? "<a href=\"" + path + "\">" + path + "</a>" : path) +
            "</td></tr>\n";
  }
  return R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>graspdb</title>
<style>
body { font-family: sans-serif; margin: 2em auto; max-width: 45em; }
pre, td { font-family: monospace; }
pre { background: #eee; overflow-x: auto; padding: 1em; }
td { padding-right: 2em; }
</style>
</head>
<body>
<h1>graspdb</h1>
<p>Send a mesh, get grasps back:</p>
<pre>curl --data-binary @mug.stl 'http://localhost:8080/v1/grasps?category=mug&amp;units=mm'</pre>
<p>The whole contract is at <a href="/openapi.json">/openapi.json</a>.</p>
<table>
)" + rows +
         R"(</table>
</body>
</html>
)";
}

}  // namespace graspdb
