// vtk.js, in the frame, draws and turns. Here its actors, one for each cut and field, are shown or hidden.
(() => {
  const frame = document.getElementById("crater");
  const colour = document.getElementById("colour");
  const cut = document.getElementById("cut");
  const actors = JSON.parse(frame.dataset.actors);

  // The viewer leaves its window here once it has loaded.
  const view = () => frame.contentWindow?.global?.renderWindow;
  const drawn = () => (view()?.getRenderers() ?? []).flatMap((renderer) => renderer.getActors());

  function show() {
    drawn().forEach((actor, n) => actor.setVisibility(actors[n][0] === cut.value && actors[n][1] === colour.value));
    document.querySelectorAll("[data-bar]").forEach((bar) => { bar.hidden = bar.dataset.bar !== colour.value; });
    view().render();
  }

  const waiting = setInterval(() => {
    if (drawn().length !== actors.length) return;
    clearInterval(waiting);
    colour.addEventListener("change", show);
    cut.addEventListener("change", show);
    show();
    frame.dataset.ready = "yes";
  }, 50);
})();
