// The words by which a reader brings a shape along: the only ones that are in the page before it is asked for.
import type { Language } from "../../exhibits/say";

export const BRING: Record<Language, string> = {
  en: "Bring your own shape",
  zh: "带上你自己的形状",
};

/** What stands there if the rest cannot be loaded. */
export const AWAY: Record<Language, string> = {
  en: "This part of the page could not be loaded, because of the network or the host. Reload the page to try again.",
  zh: "这一部分未能加载：网络或服务器没有给出文件。请重新加载本页再试。",
};
