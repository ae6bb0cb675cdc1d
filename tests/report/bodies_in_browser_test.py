"""Bodies of a page in headless Chromium: they come first, play, and are exported as animations that are opened again.

usage: bodies_in_browser_test.py TOOL SOURCE BROWSER
"""

import base64
import sys
import time
import unittest

from animation_files import gif_frames, webm_times
from browser_page import Page

TIME = "Number(document.querySelector('.slider-time').textContent.split('= ')[1])"
GHOSTS = "[...document.querySelectorAll('.strobe .ghost')].filter((one) => one.getAttribute('display') !== 'none').length"


def button(text):
    return f"[...document.querySelectorAll('.bodies-card button')].find((one) => one.textContent === '{text}')"


class Bodies(Page):
    def choose(self, label, checked):
        self.value(f"(() => {{ const box = [...document.querySelectorAll('.bodies-card .switch, .slider label')].find((one) =>"
                   f" one.textContent === '{label}').querySelector('input'); if (box.checked !== {checked}) box.click(); }})()")

    def speed(self, units):
        self.value("(() => { const pick = document.querySelector('select[aria-label=speed]');"
                   f" pick.value = '{units}'; pick.dispatchEvent(new Event('change')); }})()")

    def test_they_are_first_and_a_square_scene_fills_its_card(self):
        self.show("ball-in-box")
        order = "[...document.querySelectorAll('.layout .card')].map((card) => card.className.split(' ').at(-1))"
        self.assertEqual(self.value(order), ["bodies-card", "drawing", "event-list"])
        self.browser.open((self.folder / "page.html").as_uri(), 1400, 900, "light")
        square = "document.querySelector('.bodies').getBoundingClientRect()"
        holder = "document.querySelector('.bodies-holder').getBoundingClientRect()"
        self.assertGreater(self.value(f"{square}.width / {holder}.width"), 0.6)
        self.assertLess(self.value(f"{square}.bottom"), 900)
        middle = self.value(f"({square}.left + {square}.right - {holder}.left - {holder}.right) / 2")
        self.assertLess(abs(middle), 2)

    def test_ghosts_are_switched_and_those_of_the_future_wait_while_it_plays(self):
        self.show("sliding-ball")
        self.assertEqual(self.value(GHOSTS), 14)
        self.choose("ghosts", "false")
        self.assertEqual(self.value(GHOSTS), 0)
        self.choose("ghosts", "true")
        self.speed("0.1")
        self.value(button("play") + ".click()")
        end = time.monotonic() + 60
        while self.value(TIME) == 0 and time.monotonic() < end:
            self.browser.wait(0.1)
        self.assertLess(self.value(GHOSTS), 14)
        self.value(button("pause") + ".click()")
        self.assertEqual(self.value(GHOSTS), 14)

    def test_loop_begins_again(self):
        self.show("sliding-ball")
        self.choose("loop", "true")
        self.speed("5")
        self.value("window.back = 0; window.last = 0; new MutationObserver(() => { const now = " + TIME + ";"
                   " if (now < window.last) window.back += 1; window.last = now; })"
                   ".observe(document.querySelector('.slider-time'), {childList: true, characterData: true, subtree: true})")
        self.value(button("play") + ".click()")
        self.becomes("window.back > 1", True)
        self.assertEqual(self.value(button("pause") + " !== undefined"), True)

    def test_the_picture_follows_what_moves(self):
        self.show("ball-in-box")
        ball = "Number(document.querySelector('.bodies .moving circle').getAttribute('r'))"
        small = self.value(ball)
        self.choose("follow", "true")
        self.assertGreater(self.value(ball), 1.5 * small)
        self.choose("follow", "false")
        self.assertAlmostEqual(self.value(ball), small, delta=1e-9)


class Exports(Page):
    """A ball that slides: two units of time, at two units per second."""

    flags = "--autoplay-policy=no-user-gesture-required"

    def exported(self, word, ending):
        self.show("sliding-ball")
        session, self.browser.session = self.browser.session, None
        self.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(self.folder))
        self.browser.session = session
        self.value("(() => { const pick = document.querySelector('select[aria-label=speed]'); pick.value = '2';"
                   " pick.dispatchEvent(new Event('change')); })()")
        self.value(button(word) + ".click()")
        file, end = self.folder / f"sliding-ball{ending}", time.monotonic() + 300
        while not file.exists() and time.monotonic() < end:
            self.browser.wait(0.2)
        self.assertEqual(self.value("document.querySelector('.bodies-card [aria-live]').textContent"), "")
        self.assertFalse(self.value(button(word) + ".disabled"))
        return file.read_bytes()

    def in_an_empty_page(self, data, expression, name="window.found"):
        (self.folder / "empty.html").write_text("<!DOCTYPE html><title>empty</title>", encoding="utf-8")
        self.open("empty.html")
        self.value(f"window.bytes = Uint8Array.from(atob('{base64.b64encode(data).decode()}'), (letter) => letter.charCodeAt(0)); 1")
        self.value(f"({expression})(); 1")
        end = time.monotonic() + 120
        while (found := self.value(name)) is None and time.monotonic() < end:
            self.browser.wait(0.1)
        return found

    def test_a_gif_has_all_its_frames(self):
        data = self.exported("GIF", ".gif")
        (width, height), frames = gif_frames(data)
        # 25 steps of 4 hundredths of a second, both ends, and 0.6 s of the last one.
        self.assertEqual(len(frames), 26 + 15)
        self.assertEqual({delay for delay, _, _ in frames}, {4})
        self.assertEqual(frames[0][1], (0, 0, width, height))
        self.assertTrue(all(set(pixels) != {255} for _, _, pixels in frames[:25]))
        self.assertTrue(all(pixels == b"\xff" for _, _, pixels in frames[26:]))
        self.assertGreater(len(set(frames[0][2])), 8)
        # The browser reads the same file.
        said = self.in_an_empty_page(data, """async () => {
          const decoder = new ImageDecoder({data: window.bytes, type: "image/gif"});
          await decoder.completed; await decoder.tracks.ready;
          const {image} = await decoder.decode({frameIndex: 20});
          window.found = [decoder.tracks.selectedTrack.frameCount, image.displayWidth, image.displayHeight]; }""")
        self.assertEqual(said, [len(frames), width, height])

    def test_a_video_plays_as_long_as_the_run(self):
        data = self.exported("WebM", ".webm")
        times = webm_times(data)
        # Thirty frames a second, on a busy machine fewer.
        self.assertGreaterEqual(len(times), 5)
        self.assertLessEqual(len(times), 40)
        self.assertEqual(times, sorted(times))
        self.assertGreater(times[-1] - times[0], 900)
        said = self.in_an_empty_page(data, """() => {
          const video = document.body.appendChild(document.createElement("video"));
          video.muted = true;
          video.onended = () => { window.found = [video.videoWidth > 300, video.getVideoPlaybackQuality().totalVideoFrames]; };
          video.src = URL.createObjectURL(new Blob([window.bytes], {type: "video/webm"}));
          video.play(); }""")
        self.assertTrue(said[0])
        self.assertGreaterEqual(said[1], len(times) // 2)

    def test_a_cancelled_animation_leaves_no_file(self):
        self.show("sliding-ball")
        self.value("window.saved = 0; saltus.saveBlob = () => { window.saved += 1; }; " + button("GIF") + ".click()")
        self.value(button("cancel") + ".click()")
        self.becomes(button("GIF") + ".disabled", False)
        self.assertEqual(self.value("window.saved"), 0)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
