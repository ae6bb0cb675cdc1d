"""The pages of reports in headless Chromium: what is drawn, what answers to whom, and that nothing complains.

usage: page_in_browser_test.py TOOL SOURCE BROWSER
"""

import json
import sys
import time
import unittest

from browser_page import DRAWN, NAMES, PLANE, SELECTED, SOURCE, Page, key

AXE = SOURCE / ".venv/axe/axe.min.js"


class TwoStates(Page):
    def test_drawings_events_and_their_links(self):
        self.show("stick-slip")
        self.assertEqual(self.value(DRAWN), 2)
        self.assertEqual(self.value(NAMES), ["field", "field on both sides", "sliding field", "slip = 0", "not sliding", "sliding", "event", "begin", "end"])
        # The surface runs through the whole plane at the speed of the belt.
        self.assertTrue(all(abs(v - 0.2) < 1e-15 for v in self.value(PLANE + ".data[3].y.slice(0, 2)")))

        self.value(key("ArrowDown"))
        self.becomes(SELECTED, "▼ Event 1: enter sliding")
        self.value(key("End"))
        self.becomes(SELECTED, "▼ Event 9: enter sliding")
        self.value(key("Enter"))
        self.becomes("document.querySelector('.timeline').layout.xaxis.range.map((t) => t > 20)", [True, True])
        self.becomes(NAMES + ".at(-1)", "event 9")
        self.value(key("Escape"))
        self.becomes("document.querySelector('.inspector').hidden", True)

    def test_several_solutions_are_a_notice_and_no_mistake(self):
        self.show("stay-or-leave")
        banner = "document.querySelector('.banner')"
        self.assertIn("not unique at 1 event", self.value(banner + ".textContent"))
        self.assertEqual(self.value(f"[{banner}.className, {banner}.getAttribute('role')]"), ["banner notice", "status"])
        self.value(banner + ".querySelector('button').click()")
        self.becomes(SELECTED, "▼ Event 2: enter sliding")

    def test_search_leaves_the_matching_events(self):
        self.show("stick-slip")
        rows = "document.querySelectorAll('.events tbody tr:not(.space)').length"
        self.assertEqual(self.value(rows), 9)
        self.value("(() => { const box = document.querySelector('.search'); box.value = 'leave';"
                   " box.dispatchEvent(new Event('input')); })()")
        self.becomes(rows, 4)

    def test_a_click_on_an_event_in_the_plane_selects_it(self):
        self.show("stick-slip")
        self.value(f"{PLANE}.emit('plotly_click', {{points: [{{customdata: 2}}]}})")
        self.becomes(SELECTED, "▼ Event 3: enter sliding")

    def test_files_and_paper(self):
        self.show("circle")
        self.value("Promise.all([...document.querySelectorAll('.js-plotly-plot')].map((drawing) => Plotly.toImage("
                   "{data: drawing.data, layout: drawing.layout}, {format: 'svg', width: 700, height: 500})))"
                   ".then((images) => { window.images = images.map((text) => text.slice(0, 18)); })")
        self.becomes("window.images", ["data:image/svg+xml"] * 2)
        self.value("document.querySelector('.theme').click()")
        self.assertEqual(self.value("document.documentElement.dataset.theme"), "dark")
        self.value("window.dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(self.value("document.documentElement.dataset.theme"), "light")
        self.assertEqual(self.value("document.documentElement.className"), "paper")
        self.value("window.dispatchEvent(new Event('afterprint'))")
        self.assertEqual(self.value("document.documentElement.dataset.theme"), "dark")

    def test_names_of_others_stay_text(self):
        self.tool("simulate", "stick-slip", "--quiet", "--out", "r.json")
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        del result["record_sha256"]
        bad = "</script><img src=x onerror=window.hit=1><b>"
        result["model"]["name"] = result["model"]["description"] = bad
        result["states"][1] = result["surfaces"][0]["states"][0] = bad
        result["switching_functions"][0] = result["surfaces"][0]["name"] = bad
        result["events"][0].update(name=bad, reason=bad, surfaces=[bad], unique=False)
        (self.folder / "bad.json").write_text(json.dumps(result), encoding="utf-8")
        self.tool("report", "bad.json")
        self.open("bad.html")
        self.assertEqual(self.value(DRAWN), 2)
        self.value(key("ArrowDown"))
        self.becomes("document.querySelector('.inspector').hidden", False)
        self.assertEqual(self.value("[window.hit === undefined, document.querySelectorAll('img, b').length]"), [True, 0])
        self.assertEqual(self.value("document.querySelector('h1').textContent"), bad)


class Columns(Page):
    def panels(self):
        return self.value("[...document.querySelectorAll('.panel-rows .names')].map((e) => e.textContent)")

    def press(self, selector):
        self.value(f"document.querySelector(`{selector}`).click()")

    def show_many(self):
        """60 states; the second half of the blocks moves."""
        count = 30
        states = "".join(f"x{i} = {i}\nv{i} = 0\n" for i in range(count))
        moving = "".join(f'x{i} = "v{i}"\nv{i} = "{i}/30 - 0.1*v{i}"\n' if i >= count - 5 else f'x{i} = "0"\nv{i} = "0"\n'
                         for i in range(count))
        (self.folder / "many.toml").write_text(
            f'[model]\nname = "many"\n[states]\n{states}[dynamics]\n{moving}[[events]]\nname = "passes"\n'
            'when = "v29 - 1"\n[simulate]\nuntil = 3\n', encoding="utf-8")
        self.show("many.toml")

    def test_what_moves_is_drawn_and_everything_can_be_chosen(self):
        self.show_many()
        self.press(".toolbar button[aria-expanded]")
        drawn = ", ".join(self.panels()).split(", ")
        self.assertIn("v29", drawn)
        self.assertNotIn("x0", drawn)
        self.assertEqual(len(drawn), 10)
        ticks = "document.querySelectorAll('.column-ticks input').length"
        self.assertEqual(self.value(ticks), 60)
        self.value("(() => { const box = document.querySelector('.column-search'); box.value = 'x0';"
                   " box.dispatchEvent(new Event('input')); })()")
        self.becomes(ticks, 1)
        self.press(".column-ticks input")
        self.assertEqual(self.panels()[-1], "x0")
        axes = "[...document.querySelectorAll('.phase select')[0].options].map((option) => option.textContent)"
        self.assertEqual(self.value(axes)[-2:], ["v29", "t"])

    def test_many_states_fit_on_paper(self):
        self.show_many()
        self.value("window.dispatchEvent(new Event('beforeprint'))")
        width = self.value("Math.max(...[...document.querySelectorAll('table')].map((one) => one.getBoundingClientRect().right))")
        self.assertLess(width, 721)
        equations = "document.querySelector('.equations')"
        self.assertEqual(self.value(f"{equations}.scrollHeight - {equations}.clientHeight"), 0)

    def test_long_names_leave_room_for_equations_and_values(self):
        rotor, winding = "angular_velocity_of_the_rotor", "temperature_of_the_left_hand_outer_winding_of_the_second_stage_of_machine"
        (self.folder / "names.toml").write_text(
            f'[model]\nname = "names"\n[states]\n{rotor} = 1.25\n{winding} = 0.3333333333333\np = 0\n[dynamics]\n'
            f'{rotor} = "-0.3*sign({rotor}) + sin({winding})"\n{winding} = "cos({rotor})"\np = "1"\n'
            "[simulate]\nuntil = 5\n", encoding="utf-8")
        self.show("names.toml")
        heights = ("[...document.querySelectorAll('.info .plain td.digits, .equations td:first-of-type')].map("
                   "(cell) => { const text = document.createRange(); text.selectNodeContents(cell);"
                   " return text.getBoundingClientRect().height; })")
        for width in (1280, 390):
            self.browser.open((self.folder / "page.html").as_uri(), width, 800, "light")
            self.assertEqual(self.value("document.documentElement.scrollWidth"), width)
            self.assertLess(max(self.value(heights)), 3 * 20, width)
        self.value("window.dispatchEvent(new Event('beforeprint'))")
        right = "Math.max(...[...document.querySelectorAll('.info table')].map((one) => one.getBoundingClientRect().right))"
        self.assertLess(self.value(right), 721)

    def test_panels_are_ordered_joined_and_kept_in_the_address(self):
        self.show("stick-slip")
        self.press(".toolbar button[aria-expanded]")
        self.assertEqual(self.panels(), ["q", "v", "α(slip)"])
        self.press("[aria-label='move up: v']")
        self.assertEqual(self.panels(), ["v", "q", "α(slip)"])
        self.press("[aria-label='onto the axis above: q']")
        self.assertEqual(self.panels(), ["v, q", "α(slip)"])
        self.press("[aria-label='mode slip']")
        self.press("[aria-label='logarithmic axis: α(slip)']")
        self.value("document.querySelector('.timeline').emit('plotly_relayout',"
                   " {'xaxis.range[0]': 5, 'xaxis.range[1]': 20})")
        self.becomes("decodeURIComponent(location.hash)", "#c=1+0,l2;&t=5,20")
        address = self.value("location.href")
        self.browser.open(address, 1366, 768, "light")
        self.press(".toolbar button[aria-expanded]")
        self.assertEqual(self.panels(), ["v, q", "α(slip)"])
        self.assertEqual(self.value("document.querySelector('.timeline').layout.xaxis.range"), [5, 20])

    def drag(self, drawing):
        """Draws a frame within a drawing with the mouse."""
        left, top, width, height = self.value(
            f"(() => {{ const drawing = document.querySelector('{drawing}'); drawing.scrollIntoView({{block: 'center'}});"
            " const frame = drawing.querySelector('.nsewdrag').getBoundingClientRect();"
            " return [frame.x, frame.y, frame.width, frame.height]; })()")
        self.browser.act(f"drag {left + 0.2 * width} {top + 0.3 * height} {left + 0.5 * width} {top + 0.6 * height}")

    def test_what_was_zoomed_to_by_the_mouse_is_left_again(self):
        self.show("stick-slip")
        whole = self.value("document.querySelector('.timeline').layout.xaxis.range.slice()")
        self.drag(".timeline")
        window = "document.querySelector('.timeline').layout.xaxis.range.map((t) => Math.round(t))"
        self.becomes(window, [8, 20])
        self.becomes("location.hash.startsWith('#t=')", True)
        self.value("[...document.querySelectorAll('button')].find((one) => one.textContent === 'whole time').click()")
        self.becomes("document.querySelector('.timeline').layout.xaxis.range", whole)
        self.becomes("location.hash", "")

        ranges = f"(({PLANE}).layout.xaxis.range.concat(({PLANE}).layout.yaxis.range).map((one) => +one.toFixed(6)))"
        plane = self.value(ranges)
        self.drag(".phase-plot")
        self.becomes(f"JSON.stringify({ranges}) !== '{json.dumps(plane, separators=(',', ':'))}'", True)
        self.value(f"({PLANE}).emit('plotly_doubleclick')")
        self.becomes(ranges, plane)

    def test_scales_of_the_plane_are_kept_in_the_address(self):
        self.show("stick-slip")
        self.value("[...document.querySelectorAll('.phase label')].find((one) => one.textContent === 'log x')"
                   ".querySelector('input').click()")
        self.becomes("location.hash", "#scales=log-x")
        address = self.value("location.href")
        self.browser.open(address, 1366, 768, "light")
        self.assertEqual(self.value(PLANE + ".layout.xaxis.type"), "log")

    def test_selections_and_time_are_axes_of_the_plane(self):
        self.show("stick-slip")
        for place, name in ((0, "α(slip)"), (1, "t")):
            self.value(f"(() => {{ const list = document.querySelectorAll('.phase select')[{place}];"
                       f" list.value = [...list.options].find((option) => option.textContent === '{name}').value;"
                       " list.dispatchEvent(new Event('change')); })()")
        self.becomes(PLANE + ".layout.xaxis.title.text", "t")
        self.assertEqual(self.value(PLANE + ".layout.yaxis.title.text"), "α(slip)")
        self.assertEqual(self.value(PLANE + ".layout.xaxis.range.map(Math.round)"), [-2, 42])


class Chattering(Page):
    def test_both_sides_are_seen_and_the_control_has_an_envelope(self):
        (self.folder / "fast.toml").write_text("""
[model]
name = "fast"
[states]
x = 1
v = 0
[dynamics]
x = "v"
v = "-4e6*x"
[outputs]
u = "sign(x)"
[switching]
s = "x"
[simulate]
until = 3
""", encoding="utf-8")
        self.show("fast.toml")
        events = self.value("saltus.result.events.length")
        self.assertGreater(events, 1000)
        metas = "[...new Set(document.querySelector('.timeline').data.map((trace) => trace.meta).filter((m) => m))].sort()"
        self.assertEqual(self.value(metas), ["envelope", "mean", "mode -1", "mode 1", "mode chattering"])
        means = self.value("document.querySelector('.timeline').data.filter((trace) => trace.meta === 'mean')[0]"
                           ".y.filter((y) => y !== null)")
        self.assertLess(abs(sum(means) / len(means)), 0.05)


class Bodies(Page):
    MOVING = "[...document.querySelectorAll('.bodies .moving circle')].map((ball) => Number(ball.getAttribute('cy')))"

    def slide(self, value):
        self.value("(() => { const slider = document.querySelector('.slider input'); "
                   f"slider.value = '{value}'; slider.dispatchEvent(new Event('input')); }})()")

    def test_a_ball_falls_with_the_slider_and_lies_with_the_selected_event(self):
        self.show("sliding-ball")
        at_start = self.value(self.MOVING)[0]
        # Fourteen frames of it, and a floor that stands still.
        self.assertEqual(self.value("document.querySelectorAll('.bodies .strobe circle').length"), 14)
        self.assertEqual(self.value("document.querySelectorAll('.bodies .strobe polyline, .bodies .moving polyline').length"), 0)
        self.assertEqual(self.value("document.querySelectorAll('.bodies .inside > polyline').length"), 1)
        self.slide(1000)
        floor = "Number(document.querySelector('.bodies .inside > polyline').getAttribute('points').split(/[ ,]/)[1])"
        radius = "Number(document.querySelector('.bodies .moving circle').getAttribute('r'))"
        self.assertGreater(self.value(self.MOVING)[0], at_start)
        self.assertAlmostEqual(self.value(floor) - self.value(self.MOVING)[0], self.value(radius), delta=1e-6)
        self.slide(0)
        self.assertEqual(self.value(self.MOVING)[0], at_start)
        self.value(key("ArrowDown"))
        self.becomes("document.querySelector('.slider-time').textContent", "t = 0.44721")
        phases = "[...document.querySelectorAll('.contact-strip rect title')].map((title) => title.textContent.split(',')[0])"
        self.assertEqual(self.value(phases), ["ground slips", "ground sticks"])

    def test_play_comes_to_the_end_and_paper_shows_the_strobe(self):
        self.show("sliding-ball")
        self.slide(990)
        button = "document.querySelector('.slider button')"
        self.value(button + ".click()")
        self.becomes(button + ".textContent", "play")
        self.becomes("document.querySelector('.slider-time').textContent", "t = 2")
        self.value("window.dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(self.value("getComputedStyle(document.querySelector('.slider')).display"), "none")
        self.assertGreater(self.value("document.querySelector('.bodies').getBoundingClientRect().height"), 50)
        self.value("window.dispatchEvent(new Event('afterprint'))")

    def test_contacts_without_a_drawing_have_their_phases(self):
        model = (SOURCE / "models/sliding-ball.toml").read_text(encoding="utf-8")
        lines = [line for line in model.splitlines() if not line.startswith("draw")]
        (self.folder / "m.toml").write_text("\n".join(lines), encoding="utf-8")
        self.show("m.toml")
        self.assertEqual(self.value("document.querySelector('.bodies-card h2').textContent"), "Contacts")
        self.assertEqual(self.value("document.querySelectorAll('.bodies').length"), 0)


class ThreeStates(Page):
    def test_the_portrait_has_curve_and_plane(self):
        self.show("relay-feedback")
        self.value("window.scrollTo(0, document.body.scrollHeight)")
        self.becomes(DRAWN, 3)
        kinds = self.value("document.querySelectorAll('.phase-plot')[1].data.map((trace) => trace.type)")
        self.assertIn("scatter3d", kinds)
        self.assertEqual(kinds.count("mesh3d"), 1)
        self.assertEqual(self.value("document.querySelectorAll('.phase-plot')[1].data.at(-1).x.every((x) => "
                                    "Math.abs(x) < 1e-15)"), True)


class Accessibility(Page):
    """Of axe-core, which `scripts/install.sh developer` brings where npm is there, no rule is broken."""

    def broken(self, width, theme):
        self.browser.open((self.folder / "page.html").as_uri(), width, 900, theme)
        self.value("document.querySelector('.toolbar button[aria-expanded]').click()")
        return self.rules()

    def rules(self):
        self.value(AXE.read_text(encoding="utf-8") + "; 1")
        self.value("axe.run(document).then((found) => { window.passed = found.passes.length; window.broken ="
                   " found.violations.map((rule) => rule.id + ' ' + rule.nodes[0].target); }); 1")
        end = time.monotonic() + 600
        while self.value("window.passed ?? 0") == 0 and time.monotonic() < end:
            time.sleep(0.1)
        self.assertGreater(self.value("window.passed"), 20)
        return self.value("window.broken")

    @unittest.skipUnless(AXE.exists(), "no axe-core")
    def test_light_dark_narrow_and_in_print(self):
        self.tool("simulate", "stick-slip", "--quiet", "--report", "page.html")
        for width, theme in ((1366, "light"), (1366, "dark"), (390, "light")):
            self.assertEqual(self.broken(width, theme), [], (width, theme))
        self.assertEqual(self.value("document.documentElement.scrollWidth"), 390)
        self.broken(1366, "light")
        self.value("window.dispatchEvent(new Event('beforeprint')); delete window.passed")
        self.assertEqual(self.rules(), [])

    def test_the_time_is_moved_by_keys(self):
        self.show("stick-slip")
        holder = "document.querySelector('.timeline')"
        window = holder + ".layout.xaxis.range.map((t) => Math.round(t))"

        def press(name):
            self.value(f"{holder}.dispatchEvent(new KeyboardEvent('keydown', {{key: '{name}', bubbles: true}}))")

        press("+")
        self.becomes(window, [10, 30])
        press("ArrowRight")
        self.becomes(window, [14, 34])
        press("0")
        self.becomes(window, [0, 40])


class WithoutWebGL(Page):
    flags = "--disable-3d-apis"

    def test_the_page_says_so_and_shows_the_rest(self):
        self.show("relay-feedback")
        self.value("window.scrollTo(0, document.body.scrollHeight)")
        self.becomes("document.querySelector('.absent').textContent.includes('WebGL')", True)
        self.assertEqual(self.value(DRAWN), 2)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], "-v"])
