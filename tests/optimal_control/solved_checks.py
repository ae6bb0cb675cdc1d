"""What `completed` promises of an optimisation, read from its JSON alone."""

RESIDUALS = ("primal_infeasibility", "complementarity_residual", "stationarity")


class Faults(list):
    """Sentences about what does not hold."""

    def expect(self, holds, sentence):
        if not holds:
            self.append(sentence)

    def expect_near(self, value, expected, tolerance, what):
        self.expect(abs(value - expected) <= tolerance, f"{what}: {value:.6g} instead of {expected:.6g}")


def faults_of_certificate(result):
    """All residuals within the tolerance, B-stationary, and no interval off by more than its tolerance."""
    faults = Faults()
    certificate, verification = result["certificate"], result["verification"]
    tolerance = result["options"]["optimize.mpcc.tolerance"]
    for key in RESIDUALS:
        value = certificate[key]
        faults.expect(value is not None and value <= tolerance, f"{key} is {value}")
    faults.expect(certificate["b_stationary"] is True, f"b_stationary is {certificate['b_stationary']}")
    defect = verification["interval_defect"]
    faults.expect(defect is not None and defect <= verification["tolerance"], f"interval_defect is {defect}")
    return faults


def ranges_of(nodes):
    """How far each state goes over the nodes."""
    return [max(max(values) - min(values), 1e-6) for values in zip(*nodes)]
