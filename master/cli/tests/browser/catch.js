// Stands first in a page that is looked at: keeps errors, and what would be saved.
window.errors = [];
window.saved = [];
addEventListener("error", (event) => errors.push(String(event.message)));
addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));
{
  const said = console.error;
  console.error = (...words) => { errors.push(words.join(" ")); said(...words); };
  const sizes = new Map();
  const make = URL.createObjectURL;
  URL.createObjectURL = (blob) => { const url = make.call(URL, blob); sizes.set(url, blob.size); return url; };
  HTMLAnchorElement.prototype.click = function () {
    saved.push({ name: this.download, size: sizes.get(this.href) ?? this.href.length });
  };
}
