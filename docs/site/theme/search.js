// Gives the search of the theme its index when the reader turns to it, not with every page. From disk a browser neither
// fetches the index nor starts a worker from a file: there the index comes as a script, and the worker is made from its
// text, which build.py puts here.
{
  const folder = new URL('../search/', document.currentScript.src);
  const from_disk = location.protocol === 'file:';

  const wanted = new Promise((resolve) => {
    // Words in the address are to be found, or marked.
    if (/[?&][qh]=/.test(location.search)) resolve();
    addEventListener('focusin', ({target}) => {
      if (target.matches('.md-search__input')) resolve();
    });
  });

  const given = () =>
    new Promise((resolve) => {
      globalThis.giveSearchIndex = resolve;
      document.head.append(Object.assign(document.createElement('script'), {src: new URL('search_index.js', folder)}));
    });
  const fetched = async () => (await fetch(new URL('search_index.json', folder))).json();

  globalThis.__search = {index: wanted.then(from_disk ? given : fetched)};
  if (from_disk) {
    globalThis.__search.worker = URL.createObjectURL(new Blob([WORKER_TEXT], {type: 'text/javascript'}));
  }
}
