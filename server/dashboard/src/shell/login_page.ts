// Exchanges a token for the cookie of the login, and goes back to where the login was asked for.
import { access, send } from "../api/client";
import { asksForTokens, setLoggedIn } from "../api/curl";
import { ApiError, messageOf } from "../api/api_error";
import { live } from "../api/live";
import { h } from "../base/h";
import type { OpenPage } from "./page";
import { navigate } from "./router";

/** Only a path of ours: a link to the login must not lead elsewhere afterwards. */
function pathBack(query: URLSearchParams): string {
  const back = query.get("back") ?? "/";
  return /^\/(?![/\\])/.test(back) && !back.startsWith("/login") ? back : "/";
}

export const openLoginPage: OpenPage = ({ query, setTitle }) => {
  setTitle("Log in");
  const trouble = h("p", { class: "field-error", id: "token-error", role: "alert" });
  const token = h("input", {
    id: "token", type: "password", autocomplete: "current-password", maxlength: 64, required: true, spellcheck: "false",
    "aria-describedby": "token-help token-error", placeholder: "kl_…",
  });
  const button = h("button", { class: "primary", type: "submit" }, "Log in");
  const form = h("form", { class: "login card", onsubmit: (event) => { event.preventDefault(); void logIn(); } },
    h("label", { for: "token" }, "Token"), token,
    h("p", { class: "muted", id: "token-help" }, "Who runs this service makes one with ", h("code", null, "keylume-server token create NAME"),
      ". It is exchanged for a login of a week at most, in a cookie that scripts cannot read; the token is not kept in this browser."),
    trouble, h("div", null, button));

  async function logIn(): Promise<void> {
    button.disabled = true;
    trouble.textContent = "";
    try {
      await send("post", "/v1/login", { json: { token: token.value.trim() } });
      setLoggedIn(true);
      access.value = "granted";
      live.retry();
      navigate(pathBack(query), { replace: true });
    } catch (error) {
      trouble.textContent = error instanceof ApiError && error.status === 401
        ? "This token is not known here, has expired or was revoked." : messageOf(error);
      token.setAttribute("aria-invalid", "true");
      token.select();
    }
    button.disabled = false;
  }
  return form;
};

export async function logOut(): Promise<void> {
  await send("post", "/v1/logout");
  setLoggedIn(false);
  access.value = "denied";
}

export const isLoggedIn = asksForTokens;
