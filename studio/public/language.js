// Before anything is drawn: takes a reader to the page in their language. The address may name one (l=zh); else a
// browser that prefers the other language to this page's leaves index.html, and whoever opened zh.html meant it.
(function () {
  var pages = { en: "index.html", zh: "zh.html" };
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
  if (reads !== here) location.replace(pages[reads] + location.search + location.hash);
})();
