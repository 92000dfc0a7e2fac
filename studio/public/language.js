// Before anything is drawn: takes a reader to the page in their language, or to the exhibit that the address names
// (?exhibit=quad). The address may name a language (l=zh); else a browser that prefers the other language to this page's
// leaves index.html or lesson.html, and whoever opened zh.html meant it.
(function () {
  var isLesson = document.documentElement.dataset.exhibit === "lesson";
  var pages = isLesson ? { en: "lesson.html", zh: "lesson.zh.html" } : { en: "index.html", zh: "zh.html" };
  // Written by scripts/build.mjs.
  var exhibits = [];
  var here = /^zh/i.test(document.documentElement.lang) ? "zh" : "en";
  var wish = /(?:^#|&)l=(en|zh)(?:&|$)/.exec(location.hash);
  var reads = wish ? wish[1] : here;
  if (!wish && here === "en") {
    for (var i = 0; i < navigator.languages.length; i++) {
      var known = /^(zh|en)\b/i.exec(navigator.languages[i]);
      if (known) {
        reads = known[1].toLowerCase();
        break;
      }
    }
  }
  var query = new URLSearchParams(location.search);
  var exhibit = query.get("exhibit");
  if (exhibits.indexOf(exhibit) >= 0) {
    query.delete("exhibit");
    var search = query.toString();
    // An exhibit's page says its language by its name.
    var parts = location.hash.slice(1).split("&");
    if (wish) parts.splice(parts.indexOf("l=" + wish[1]), 1);
    var hash = parts.join("&");
    location.replace(exhibit + (reads === "zh" ? ".zh" : "") + ".html" + (search && "?" + search) + (hash && "#" + hash));
  } else if (reads !== here) location.replace(pages[reads] + location.search + location.hash);
})();
