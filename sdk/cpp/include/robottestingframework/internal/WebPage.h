// SPDX-License-Identifier: Apache-2.0
// The page of the web listener.
#ifndef ROBOTTESTINGFRAMEWORK_INTERNAL_WEBPAGE_H
#define ROBOTTESTINGFRAMEWORK_INTERNAL_WEBPAGE_H

namespace robottestingframework {
namespace internal {

// Polls for events once a second, and shows them as text, never as HTML.
inline const char *web_page()
{
    return R"page(<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<title>Robot Testing Framework</title>
<style>
body { font-family: sans-serif; margin: 2em; }
li { font-family: monospace; list-style: none; white-space: pre-wrap; }
.error, .failure { color: #b00020; }
</style>
<h1>Robot Testing Framework</h1>
<p id="state">waiting</p>
<ol id="events"></ol>
<script>
let next = 0;
async function ask() {
  const state = document.getElementById("state");
  try {
    const news = await (await fetch("/events?from=" + next)).json();
    next = news.next;
    for (const event of news.events) {
      const item = document.createElement("li");
      item.className = event.kind;
      item.textContent = [event.kind, event.name, event.text].filter(Boolean).join("  ");
      document.getElementById("events").append(item);
    }
    state.textContent = news.running ? "running" : "finished";
  } catch (problem) {
    state.textContent = "the program has ended";
  }
  setTimeout(ask, 1000);
}
ask();
</script>
</html>
)page";
}

} // namespace internal
} // namespace robottestingframework

#endif
