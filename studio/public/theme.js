// Before anything is drawn: the colours that the reader chose, or those of the system. The first page's address may name others
// (h=l, h=d, h=a). The choice is made in any `select` with `data-themes`, on every page, and remembered where that is allowed.
(function () {
  var html = document.documentElement;
  var KEY = "chordal theme";
  var chosen = null;
  try {
    chosen = localStorage.getItem(KEY);
  } catch {
    // Then it lasts as long as the page.
  }

  function named() {
    var names = { a: "auto", l: "light", d: "dark" };
    var found = html.dataset.exhibit === undefined && /(?:^#|&)h=([ald])(?:&|$)/.exec(location.hash);
    return found ? names[found[1]] : null;
  }

  function wear(wish) {
    var theme = wish === "light" || wish === "dark" ? wish : "auto";
    html.dataset.theme = theme;
    // What the browser draws before the style sheet is there.
    var scheme = document.querySelector('meta[name="color-scheme"]');
    if (scheme) scheme.content = theme === "auto" ? "light dark" : theme;
    document.querySelectorAll("[data-themes]").forEach(function (select) {
      select.value = theme;
    });
  }

  function look() {
    wear(named() || chosen);
  }

  look();
  addEventListener("DOMContentLoaded", look);
  addEventListener("hashchange", look);
  addEventListener("popstate", look);
  // Another page of ours was told.
  addEventListener("storage", function (event) {
    if (event.key !== KEY) return;
    chosen = event.newValue;
    look();
  });
  addEventListener("change", function (event) {
    if (!event.target.matches || !event.target.matches("[data-themes]")) return;
    chosen = event.target.value;
    try {
      localStorage.setItem(KEY, chosen);
    } catch {
      // Then it lasts as long as the page.
    }
    wear(chosen);
  });
})();
