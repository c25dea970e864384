// Names in tables are long. They break behind an underscore, a point or a slash, and nowhere else.
for (const name of document.querySelectorAll(".content td code")) {
  if (name.children.length) continue;
  const parts = name.textContent.split(/(?<=[_./])/);
  name.replaceChildren(...parts.flatMap((part) => [part, document.createElement("wbr")]).slice(0, -1));
}
