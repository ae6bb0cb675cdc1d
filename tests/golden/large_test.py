"""Large systems: cost by counts, which do not depend on the machine; what is shown of them."""

import itertools
import json
import sys

import tool

sys.path.insert(0, str(tool.SOURCE / "benchmarks" / "large"))
import large_models  # noqa: E402  (the folder is known only now)


def text(kind, n):
    return large_models.text(tool.TOOL, kind, n)


# Of the chain of five blocks, by dense matrices and one surface after the other (version 445bf42).
CHAIN_OF_FIVE = (
    0.016588560032445757, 0.15027915983057896, 1.1033939423135588, 1.6068188324285455, 1.8261479022443725,
    2.4283928248715365, 5.82806615651795, 6.9537881341652135, 7.918104800519034, 8.030641902647353, 8.872319622744786,
    13.830418084357017, 14.215681452193769)


HEAP = """[model]
name = "heap"
[parameters]
r = 0.2
mu = 0.3
e = {e}
[states]
{states}
[mechanics]
positions = [{positions}]
velocities = [{velocities}]
mass = [{mass}]
potential = "9.81*({heights})"
{contacts}
[simulate]
until = {until}
"""


def contact(name, gap, tangent):
    row = ", ".join(f'{position} = "{value}"' for position, value in tangent.items())
    return f'[[contacts]]\nname = "{name}"\ngap = "{gap}"\nfriction = "mu"\nrestitution = "e"\ntangent = {{ {row} }}\n'


def pair(i, j):
    """Discs i and j, with the tangent at a right angle to the line between their centres."""
    distance = f"sqrt((x{i} - x{j})^2 + (y{i} - y{j})^2)"
    along, across = f"(y{i} - y{j})/{distance}", f"(x{i} - x{j})/{distance}"
    tangent = {f"x{i}": along, f"y{i}": f"-{across}", f"x{j}": f"-{along}", f"y{j}": across, f"h{i}": "r", f"h{j}": "r"}
    return contact(f"c{i}_{j}", f"{distance} - 2*r", tangent)


def heap(discs, width, until, e=0.0, out_of_reach=0):
    """Discs above each other, in rows, fall into a box; further floors far below them touch nothing."""
    in_a_row = max(2, int(width / 0.45))
    states, contacts = [], []
    for i in range(discs):
        row, place = divmod(i, in_a_row)
        shift = 0.02 * ((7 * i) % 5 - 2)
        states.append(f"x{i} = {0.27 + 0.45 * place + 0.3 * shift}\ny{i} = {0.25 + 0.45 * row + abs(shift)}\nh{i} = 0")
        states.append(f"vx{i} = {5 * shift}\nvy{i} = 0\nw{i} = 0")
        contacts.append(contact(f"floor{i}", f"y{i} - r", {f"x{i}": "1", f"h{i}": "r"}))
        contacts.append(contact(f"left{i}", f"x{i} - r", {f"y{i}": "-1", f"h{i}": "r"}))
        contacts.append(contact(f"right{i}", f"{width} - x{i} - r", {f"y{i}": "1", f"h{i}": "r"}))
    contacts += [pair(i, j) for i, j in itertools.combinations(range(discs), 2)]
    contacts += [contact(f"far{k}", f"y0 + {100 + k}", {"x0": "1"}) for k in range(out_of_reach)]
    names = [(f"x{i}", f"y{i}", f"h{i}") for i in range(discs)], [(f"vx{i}", f"vy{i}", f"w{i}") for i in range(discs)]
    positions, velocities = ([f'"{name}"' for name in itertools.chain(*groups)] for groups in names)
    mass = []
    for i in range(3 * discs):
        row = ["0"] * (3 * discs)
        row[i] = '"r^2/2"' if i % 3 == 2 else "1"
        mass.append("[" + ", ".join(row) + "]")
    return HEAP.format(e=e, states="\n".join(states), positions=", ".join(positions), velocities=", ".join(velocities),
                            mass=",\n".join(mass), heights=" + ".join(f"y{i}" for i in range(discs)),
                            contacts="\n".join(contacts), until=until)


PRESSED = """[model]
name = "pressed"
[states]
y = 0
x = 0
q = 0
v = 0
u = 0.5
w = 0.3
[mechanics]
positions = ["y", "x", "q"]
velocities = ["v", "u", "w"]
mass = [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]]
force = { v = "-10 + (1 + 2*sign(w))*sign(w)", w = "-2*sign(w) + 0.7 + 0.2*sin(t)" }
[parameters]
mu = 0.1
e = 0
[simulate]
until = 0.6
"""


def wall(base, until):
    """Bricks of mass 1 in rows of `base`, base - 1, ... with friction 0.6, each on the corners of two of the row below."""
    half, low, friction = 0.25, 0.05, 0.6
    places = [(row, 2.02 * half * (row / 2 + k), (2 * row + 1) * low) for row in range(base) for k in range(base - row)]
    bricks = range(len(places))
    names = [[f"{letter}{i}" for i in bricks for letter in letters] for letters in ("xzq", "uvw")]
    inertia = (half**2 + low**2) / 3
    masses = [[(inertia if i % 3 == 2 else 1) if i == k else 0 for k in range(3 * len(bricks))]
              for i in range(3 * len(bricks))]
    text = ['[model]\nname = "wall"\n[states]']
    text += [f"x{i} = {x!r}\nz{i} = {z!r}\nq{i} = 0\nu{i} = 0\nv{i} = 0\nw{i} = 0" for i, (_, x, z) in enumerate(places)]
    text += ["[mechanics]", f"positions = {json.dumps(names[0])}", f"velocities = {json.dumps(names[1])}",
             f"mass = {json.dumps(masses)}", "force = { " + ", ".join(f"v{i} = -9.81" for i in bricks) + " }"]

    def corner(i, side, height):
        return (f"({side * half}*cos(q{i}) - {height * low}*sin(q{i}))",
                f"({side * half}*sin(q{i}) + {height * low}*cos(q{i}))")

    def touch(name, gap, tangent):
        entries = ", ".join(f'{state} = "{part}"' for state, part in tangent.items())
        text.append(f'[[contacts]]\nname = "{name}"\ngap = "{gap}"\ntangent = {{ {entries} }}\nfriction = {friction}')

    def touch_face(i, side, j, up):
        """A corner of i at the face of j: its upper one for up = 1."""
        x, z = corner(i, side, -up)
        along, above, sine, cosine = f"(x{i} + {x} - x{j})", f"(z{i} + {z} - z{j})", f"sin(q{j})", f"cos(q{j})"
        touch(f"c{i}_{j}{'lu'[up > 0]}", f"{up}*({cosine}*{above} - {sine}*{along}) - {low}", {
            f"x{i}": cosine, f"z{i}": sine, f"q{i}": f"{sine}*{x} - {cosine}*{z}",
            f"x{j}": f"-{cosine}", f"z{j}": f"-{sine}", f"q{j}": f"{cosine}*{above} - {sine}*{along}"})

    for i, (row, x, _) in enumerate(places):
        for side in (-1, 1):
            across, down = corner(i, side, -1)
            if row == 0:
                touch(f"ground{i}{'lr'[side > 0]}", f"z{i} + {down}", {f"x{i}": "1", f"q{i}": f"-{down}"})
                continue
            j = next(j for j in bricks if places[j][0] == row - 1 and 0 < side * (places[j][1] - x) < 2 * half)
            touch_face(i, side, j, 1)
            touch_face(j, -side, i, -1)
    return "\n".join(text) + f"\n[simulate]\nuntil = {until}\noutput = {{ points = 11 }}\n"


class Large(tool.ToolTest):
    def model(self, kind, n):
        file = self.folder / f"{kind}-{n}.toml"
        file.write_text(text(kind, n), encoding="utf-8")
        return file

    def simulate(self, kind, n, *words):
        self.run_tool("simulate", self.model(kind, n), "--quiet", "--out", "r.json", *words, code=0)
        return json.loads((self.folder / "r.json").read_text(encoding="utf-8"))

    @staticmethod
    def evaluations_per_step(result):
        return result["statistics"]["rhs_evaluations"] / result["statistics"]["steps"]

    def test_events_of_a_chain(self):
        events = self.simulate("chain", 5)["events"]
        self.assertEqual(len(events), len(CHAIN_OF_FIVE))
        for event, time in zip(events, CHAIN_OF_FIVE):
            self.assertAlmostEqual(event["t"], time, delta=1e-9)

    def test_sliding_surfaces_are_evaluated_together(self):
        # Measured 40 and 66 evaluations per step; one surface after the other 70 and 335 (version 445bf42).
        small, large = (self.evaluations_per_step(self.simulate("chain", n, "--until", "3")) for n in (10, 40))
        self.assertLess(large, 2.0 * small)

    def test_differences_for_radau5_serve_many_columns(self):
        # Column by column each Jacobian costs n evaluations; three groups do.
        small, large = (self.evaluations_per_step(self.simulate("rod", n, "--until", "0.2", "--rtol", "1e-6"))
                        for n in (40, 160))
        self.assertLess(large, 1.3 * small)

    def test_what_is_shown_of_a_hundred_states(self):
        table, _ = self.run_tool("simulate", self.model("ladder", 50), "--until", "0.01", code=0)
        self.assertRegex(table, r"end state   100 states; --show NAME,… shows those you name")
        self.assertRegex(table, r"i1 … i50  +50  from ")
        self.assertLess(len(table.splitlines()), 40)
        checked, _ = self.run_tool("check", self.model("ladder", 120), code=0)
        self.assertIn("… (216 more; --json shows all)", checked)
        self.assertIn("more than 100 switching functions", checked)
        self.assertLess(len(checked.splitlines()), 120)

    def test_some_of_them_are_shown(self):
        model = self.model("ladder", 50)
        table, _ = self.run_tool("simulate", model, "--until", "2", "--show", "v7,i5*", code=0)
        self.assertIn("v7 = ", table)
        self.assertIn("i50 = ", table)
        self.assertNotIn("v8 = ", table)
        heading = next(line for line in table.splitlines() if line.startswith("  #"))
        self.assertRegex(heading, r"v7 +i5 +i50$")
        self.assertIn("'v77'", self.run_tool("simulate", model, "--show", "v77", code=2)[1])

    def test_models_of_any_size_are_listed_and_written(self):
        listed, _ = self.run_tool("models", code=0)
        self.assertIn("--set blocks=10", listed)
        written, _ = self.run_tool("models", "gene-network", "--set", "genes=50", "--set", "seed=7", code=0)
        again, _ = self.run_tool("models", "gene-network", "--set", "seed=7", "--set", "genes=50", code=0)
        other, _ = self.run_tool("models", "gene-network", "--set", "genes=50", code=0)
        self.assertEqual(written, again)
        self.assertNotEqual(written, other)
        self.run_tool("check", self.write("m.toml", written), code=0)

    def test_sizes_that_do_not_fit_are_refused(self):
        for words, told in ((("spring-block", "--set", "block=3"), "it has: blocks"),
                            (("spring-block", "--set", "blocks=0"), "choose 1 to"),
                            (("spring-block", "--set", "blocks=1e3"), "whole number"),
                            (("spring-block", "--set", "blocks=100000000"), "choose 1 to"),
                            (("gene-network", "--set", "seed=-1"), "choose 0 or more"),
                            (("stick-slip", "--set", "mu=3"), "saltus simulate MODEL")):
            _, error = self.run_tool("models", *words, code=2)
            self.assertIn(told, error)
        _, error = self.run_tool("simulate", "spring-block", code=2)
        self.assertIn("saltus models spring-block --set blocks=10", error)

    def test_a_misspelt_name_is_refused_where_it_stands(self):
        lines = text("chain", 1600).splitlines()
        number = next(i for i, line in enumerate(lines) if i >= 4710 and "- 2*q" in line)
        lines[number] = lines[number].replace("- 2*q", "- 2*qq")
        self.write("m.toml", "\n".join(lines))
        _, error = self.run_tool("simulate", "m.toml", code=2)
        self.assertRegex(error, rf"^m.toml:{number + 1}:\d+: error: unknown name 'qq")
        self.assertIn("did you mean", error)

    def test_a_wall_of_ten_bricks_stands_still(self):
        self.write("m.toml", wall(4, 100))
        self.run_tool("simulate", "m.toml", "--quiet", "--out", "r.json", code=0)
        result = json.loads((self.folder / "r.json").read_text(encoding="utf-8"))
        self.assertEqual(result["status"]["termination"], "completed")
        self.assertEqual(len(result["contacts"]), 32)
        self.assertEqual(result["events"], [])
        self.assertLessEqual(result["statistics"]["steps"], 100)
        start, end = result["trajectory"]["x"][0], result["final"]["x"]
        self.assertLess(max(abs(before - after) for before, after in zip(start, end, strict=True)), 1e-9)

    def test_definitions_that_unfold_are_refused(self):
        # Each has the one before four times; written out they would be 4^60 terms.
        chain = "".join(f'd{i} = "d{i - 1}*d{i - 1} + sign(d{i - 1} - 0.1)*d{i - 1}"\n' for i in range(1, 60))
        self.write("m.toml", '[model]\nname = "m"\n[states]\nx = 1\n[definitions]\nd0 = "x"\n' + chain
                   + '[dynamics]\nx = "-d59"\n[simulate]\nuntil = 1\n')
        _, error = self.run_tool("simulate", "m.toml", code=2)
        self.assertIn("nest fewer of them", error)

    def test_a_million_states_by_mistake(self):
        entries = 1_000_000
        self.write("m.toml", '[model]\nname = "m"\n[states]\n' + "".join(f"x{i} = 0\n" for i in range(entries))
                   + "[dynamics]\n" + "".join(f'x{i} = "-x{i}"\n' for i in range(entries)) + "[simulate]\nuntil = 1\n")
        _, error = self.run_tool("simulate", "m.toml", code=2)
        self.assertIn("too large for a model", error)


class Heaps(tool.ResultTest):
    def test_contacts_out_of_reach_change_nothing(self):
        """With them forces are solved for in numbers; without them they are expressions."""
        for e, integrator in ((0.0, "auto"), (0.3, "auto"), (0.0, "radau5")):
            with self.subTest(e=e, integrator=integrator):
                few, many = (self.result(heap(2, 0.95, 1, e, number), "--integrator", integrator) for number in (0, 12))
                self.assertEqual([(event["kind"], event["surfaces"]) for event in many["events"]],
                                 [(event["kind"], event["surfaces"]) for event in few["events"]])
                for event, other in zip(many["events"], few["events"], strict=True):
                    self.assertAlmostEqual(event["t"], other["t"], delta=1e-6)
                for value, other in zip(many["final"]["x"], few["final"]["x"], strict=True):
                    self.assertAlmostEqual(value, other, delta=1e-6)
                for name in ("force(floor0)", "friction(floor0)"):
                    own = few["outputs"].index(name)
                    self.assertAlmostEqual(many["final"]["outputs"][many["outputs"].index(name)], few["final"]["outputs"][own], delta=1e-6)

    def test_discs_come_to_rest_in_a_box(self):
        result = self.result(heap(4, 0.95, 2))
        self.assertEqual(result["status"]["termination"], "completed")
        self.assertLess(result["penetration"], 1e-9)
        self.falls(result)
        velocities = result["final"]["x"][12:]
        self.assertLess(max(abs(v) for v in velocities), 1.0)

    def test_forces_are_those_of_the_mixture(self):
        """Beside dynamics that are not affine in a selection that slides: few forces are expressions, many numbers."""
        forces = []
        for floors in (1, 9):
            contacts = [contact(f"floor{k}", f"y + {100 * k}", {"x": "1"}) for k in range(floors)]
            result = self.result(PRESSED + "\n".join(contacts))
            self.assertIn("enter_sliding", [event["kind"] for event in result["events"]])
            forces.append(result["final"]["outputs"][result["outputs"].index("force(floor0)")])
        self.assertAlmostEqual(forces[0], forces[1], delta=1e-9)

    def test_many_contacts_beside_a_switch(self):
        """Forces in numbers are asked for at the start, where selections are not known yet."""
        text = heap(4, 0.95, 0.4).replace("[states]\n", "[states]\nz = 0.3\n")
        result = self.result(text.replace("[[contacts]]", '[dynamics]\nz = "-sign(z)"\n[[contacts]]', 1))
        self.assertEqual(result["status"]["termination"], "completed")
        sliding = [event["t"] for event in result["events"] if event["kind"] == "enter_sliding"]
        self.assertEqual(len(sliding), 1)
        self.assertAlmostEqual(sliding[0], 0.3, delta=1e-9)

    def test_contacts_that_open_each_other_come_to_rest(self):
        """Two contacts of four discs, each of which opens as the other one closes: ever slower, down to rounding."""
        result = self.result(heap(6, 0.95, 1))
        self.assertEqual(result["status"]["termination"], "completed")
        self.assertLess(result["penetration"], 1e-9)
        self.assertLess(len(result["events"]), 200)
        self.falls(result)

    def test_a_heap_of_twenty_discs_begins_at_once(self):
        """250 contacts: what is prepared grows with their number, not with its third power."""
        result = self.result(heap(20, 2.3, 0.15))
        self.assertEqual(result["status"]["termination"], "completed")
        self.assertLess(result["penetration"], 1e-9)
        self.assertTrue(result["events"])
        self.falls(result)

    def falls(self, result):
        energy = result["outputs"].index("energy")
        rows = [row[energy] for row in result["trajectory"]["outputs"]]
        for before, after in zip(rows, rows[1:]):
            self.assertLessEqual(after, before + 1e-6)


if __name__ == "__main__":
    tool.main()
