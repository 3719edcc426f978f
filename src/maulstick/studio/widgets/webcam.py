"""Photograph that the camera of the browser's own device takes, brought as a file is."""

from typing import Final

from nicegui import Client, html, ui
from nicegui.element import Element

from maulstick.errors import InputError

_LONGEST: Final = 60.0  # seconds for a person to let the page use the camera
_SEE = """(async () => {
  const video = getHtmlElement(VIDEO);
  try {
    const stream = await navigator.mediaDevices.getUserMedia({ video: { width: { ideal: 1920 } } });
    if (video.isLeft) return stream.getTracks().forEach((track) => track.stop());
    video.srcObject = stream;
    await video.play();
    return "";
  } catch (error) { return error.name; }
})()"""
_TAKE = """(async () => {
  const video = getHtmlElement(VIDEO), canvas = document.createElement("canvas");
  canvas.width = video.videoWidth; canvas.height = video.videoHeight;
  canvas.getContext("2d").drawImage(video, 0, 0);
  const blob = await new Promise((done) => canvas.toBlob(done, "image/jpeg", 0.95));
  runMethod(CHOOSER, "addFiles", [[new File([blob], "photograph.jpg", { type: "image/jpeg" })]]);
})()"""
_LEAVE = """() => {
  const video = getHtmlElement(VIDEO);
  video.isLeft = true;
  video.srcObject?.getTracks().forEach((track) => track.stop());
}"""
_SILENCE: Final = "TimeoutError"
_REFUSALS: Final = {
    _SILENCE: f"the browser did not let the page use the camera within {_LONGEST:.0f} s; ask again, and allow it",
    "NotAllowedError": "the browser may not use the camera; allow it beside the page's address",
    "NotFoundError": "there is no camera; connect one",
    "TypeError": "the browser gives the camera to a page of this very computer alone; bring a photograph",
}


def camera_button(chooser: Element) -> ui.button:
    """Make a button that takes a photograph and brings it by an upload."""
    return ui.button("Take a photograph", icon="photo_camera", on_click=lambda: _Camera(chooser).see()).props(
        "flat no-caps"
    )


class _Camera:
    """Dialog with what the camera sees."""

    def __init__(self, chooser: Element) -> None:
        self._chooser, self._client = chooser, ui.context.client
        with ui.dialog().props('aria-label="Take a photograph"') as self._dialog, html.div().classes("sheet"):
            self._video = html.video().props("playsinline muted").classes("picture").style("max-height: 60vh")
            with ui.element().classes("line end"):
                ui.button("Leave it", on_click=self._dialog.close).props("flat")
                self._take = ui.button("Take it", icon="photo_camera", on_click=self._bring)
        self._take.disable()
        self._dialog.on("before-hide", js_handler=self._filled(_LEAVE))  # afterwards there is no video on the page
        self._dialog.on("hide", self._dialog.delete)

    async def see(self) -> None:
        """Show what the camera sees. Raises InputError where there is none that may be used."""
        self._dialog.open()
        try:
            refusal = await self._run(_SEE)
        except TimeoutError:
            refusal = _SILENCE
        if self._dialog.is_deleted:  # nobody waits for it any more
            return
        if refusal:
            self._dialog.close()
            raise InputError(_REFUSALS.get(str(refusal), f"the camera does not answer ({refusal}); connect it again"))
        self._take.enable()

    async def _bring(self) -> None:
        await self._run(_TAKE)
        self._dialog.close()

    async def _run(self, script: str) -> object:
        client: Client = self._client
        answer: object = await client.run_javascript(f"return {self._filled(script)}", timeout=_LONGEST)
        return answer

    def _filled(self, script: str) -> str:
        return script.replace("VIDEO", str(self._video.id)).replace("CHOOSER", str(self._chooser.id))
