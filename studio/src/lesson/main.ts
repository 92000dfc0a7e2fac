// Makes the lesson's page work. What the text needs is here and small; figures are loaded when they are about to be seen.
import { cards } from "./cards";
import { code } from "./code_tabs";
import { folds } from "./folds";
import { guesses } from "./guesses";
import { own } from "./own/begin";
import { terms } from "./terms";

const html = document.documentElement;
terms();
code();
guesses();
cards();
folds();
own();
html.dataset["scripted"] = "1";
void import("./live").then(({ live }) => {
  live();
  html.dataset["ready"] = "1";
});
