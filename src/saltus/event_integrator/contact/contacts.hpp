// [[contacts]] in a run: impacts, modes, and what holds closed gaps at zero.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "saltus/base/at.hpp"
#include "saltus/evaluation/contact_functions.hpp"
#include "saltus/evaluation/model_kernel.hpp"
#include "saltus/event_integrator/contact/contact_forces.hpp"
#include "saltus/event_integrator/contact/open_motion.hpp"
#include "saltus/event_integrator/mode/mode_state.hpp"
#include "saltus/linalg/factors.hpp"
#include "saltus/linalg/matrix.hpp"
#include "saltus/linalg/row_basis.hpp"
#include "saltus/model/layout.hpp"
#include "saltus/ode/stepper.hpp"

namespace saltus::event_integrator {

/// Says where contacts are asked for a new mode.
struct ContactMoment {
  double t = 0.0;
  const std::vector<double>& alpha;
  double time_scale = 0.0;  ///< over which the fields change little
  ode::Tolerances tolerances{};
};

/// Changes the activities that the kernel has, and velocities at impacts. Everything else of a contact (its forces,
/// when a mode ends) is an expression of the system (model::ContactSystem).
class Contacts {
 public:
  /// Opens all contacts.
  explicit Contacts(evaluation::ModelKernel& kernel);

  [[nodiscard]] bool none() const { return contacts_.empty(); }
  /// Returns how contacts take part in the mode that the kernel is in.
  [[nodiscard]] const Activities& activities() const { return kernel_.activities(); }
  /// Returns whether a jump is that of a contact.
  [[nodiscard]] bool owns(int jump) const { return !is_of_contact_.empty() && is_of_contact_[at(jump)]; }
  /// Returns whether an event function is a guard of such a jump.
  [[nodiscard]] bool guards(int function) const {
    return !contact_of_guard_.empty() && contact_of_guard_[at(function)] >= 0;
  }
  /// Returns how far a guard may be on the wrong side where a mode begins: the gap of a contact that has just opened is
  /// 0 to the rounding of bodies whose positions may all be 0.
  [[nodiscard]] double tolerated(int function, const Activities& activities) const;
  [[nodiscard]] double tolerated(int function) const { return tolerated(function, activities()); }
  struct GapMotion {
    double size, rate, terms, bend;  ///< sizes of the terms of the gap, and of its rate; the guard's derivatives
  };
  /// Holds the values of all contacts along a slope, for those that are asked one after the other.
  struct Along {
    bool known = false;
    std::vector<double> x, slope, ahead;
    evaluation::ContactValues here, later;
  };
  /// Returns how a guard that is the gap of a contact that is open in `activities` moves along a slope; nothing of
  /// other ones. The second derivative is a difference.
  [[nodiscard]] std::optional<GapMotion> gap_motion(int function, const ContactMoment& moment,
                                                    const Activities& activities, const std::vector<double>& x,
                                                    const std::vector<double>& slope, Along& along) const;
  /// Returns those whose jumps are in a list, or for which a condition on their jumps holds.
  template <class Condition>
  [[nodiscard]] std::vector<int> with_jumps(Condition condition) const {
    std::vector<int> result;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      if (condition(contacts_[i].jump)) result.push_back(static_cast<int>(i));
    }
    return result;
  }
  /// Returns the jump of the first contact with an impulse, or of the first closed one if more than one motion follows.
  [[nodiscard]] std::optional<int> jump_to_tell() const;
  /// Returns the impulses of what was last resolved: r, in the order of ContactPoint; empty without an impact.
  [[nodiscard]] const linalg::Vector& impulses() const { return impulses_; }

  /// Returns whether positions or velocities differ.
  [[nodiscard]] bool are_moved(const std::vector<double>& x, const std::vector<double>& x_after) const;
  /// Returns whether a gap has jumped, or a velocity along one: a closed gap is not 0 any more, an open one is
  /// negative, what sticks moves, or what slips has another speed than it may have.
  [[nodiscard]] bool have_jumped(const ContactMoment& moment, const std::vector<double>& x);
  /// Opens all contacts, as before a start. Returns what is wrong if bodies overlap.
  [[nodiscard]] std::optional<std::string> begin_anew(const ContactMoment& moment, std::vector<double>& x);
  /// Sets the velocities behind the impacts at a point, if any, and the modes there. `ended` lists the contacts whose
  /// mode ends here; x is at the zero of what ended it. Returns what is wrong if nothing follows.
  [[nodiscard]] std::optional<std::string> resolve(const ContactMoment& moment, const std::vector<int>& ended,
                                                   std::vector<double>& x);
  /// Returns why more than one motion follows what was last resolved or settled.
  [[nodiscard]] const OpenMotion& why_open() const { return why_open_; }
  /// Returns, by their jumps, the contacts whose bounces the last impact has ended: the next one would be nothing.
  [[nodiscard]] const std::vector<int>& last_bounces() const { return last_bounces_; }
  /// Returns the contacts that do not slip, to the rounding of their velocities.
  [[nodiscard]] std::vector<int> without_slip(const ContactMoment& moment, const std::vector<double>& x);
  struct Bounces {
    const std::vector<int>& jumps;  ///< of the contacts
    double left;                    ///< the time from the last impact to the limit
    std::vector<int> sticking;      ///< contacts without a slip behind the last impact
  };
  /// Ends bounces in their limit: the gaps close without an impact.
  [[nodiscard]] std::optional<std::string> settle(const ContactMoment& moment, const Bounces& bounces,
                                                  std::vector<double>& x);
  /// Says what is wrong where steps become ever smaller as a contact slips under a force that grows without bound.
  [[nodiscard]] std::optional<std::string> jam(const ContactMoment& moment, const std::vector<double>& x);
  /// Returns whether a gap or a velocity is held at 0.
  [[nodiscard]] bool hold();
  /// Evaluates the right-hand side without contact forces (n_x).
  void free_field(double t, const std::vector<double>& x, const std::vector<double>& alpha, double* f);
  enum class Slips { kept, free };
  /// Puts x on the gaps, rates and tangential velocities that are held at 0; returns whether it changed.
  /// @param slips  in a plane: kept as they are, or as free as all that is not held
  bool project(double t, const std::vector<double>& alpha, std::vector<double>& x,
               const std::vector<int>& touching = {}, Slips slips = Slips::kept);
  /// Returns whether of activities only the bounds of the speed of a slip in a plane differ.
  [[nodiscard]] bool slip_goes_on(const Activities& before, Activities after) const;
  /// Returns whether friction of a slip in a plane turns so fast that explicit steps would be short, and many.
  [[nodiscard]] bool turns_fast(const ContactMoment& moment, const std::vector<double>& x);
  /// Returns the parts of the tolerances that slips in a plane bear, down to the speed at which they are looked at
  /// next.
  [[nodiscard]] ode::Tolerances bearable(const ContactMoment& moment, const std::vector<double>& x);
  /// Returns their names, for messages.
  [[nodiscard]] std::string names(const std::vector<int>& contacts) const;

 private:
  /// Of the speed at which a slip in a plane is looked at again: small speeds are located to the rounding of t.
  static constexpr double ends_below = 1.1;
  /// Of the slowest speed, below which a slip in a plane is none: at twice its tolerance a step runs through the rest
  /// unseen, and comes out on the other side as fast as before.
  static constexpr double none_below = 3.0;
  /// Of the slowest speed: what a limit that is extrapolated may leave, and an approach whose acceleration is 0, too.
  static constexpr double rests_below = 64.0;
  /// Of the time scale: where the motion a little later is asked for.
  static constexpr double ahead_by = 1e-3;
  /// Of gaps, which are lengths: as at a start.
  static constexpr double none_at_start = 1e-12;

  [[nodiscard]] ContactPoint point_at(double t, const std::vector<double>& alpha, const std::vector<double>& x);
  void read_point(double t, const std::vector<double>& alpha, const std::vector<double>& x, ContactPoint& point);
  void read_motion(double t, const std::vector<double>& alpha, const std::vector<double>& x, ContactPoint& point);
  [[nodiscard]] double force_terms(const ContactPoint& point, double t, const std::vector<double>& alpha,
                                   const std::vector<double>& x);
  [[nodiscard]] double acceleration_terms(double t, const std::vector<double>& alpha, const std::vector<double>& x);
  [[nodiscard]] const model::Activity& activity(int contact) const { return kernel_.activities()[at(contact)]; }
  /// Lets change(activity) change that of a contact.
  template <class Change>
  void change_activity(int contact, Change change) {
    model::Activity changed = activity(contact);
    change(changed);
    kernel_.set_activity(contact, changed);
  }
  [[nodiscard]] ContactMode mode_of(int contact) const;
  /// For rows of the values that may be held at once.
  [[nodiscard]] linalg::RowBasis no_rows() const {
    constexpr double dependent = 1e-9;
    return {values_.rows.cols(), values_.rows.cols(), dependent};
  }
  struct Modes {
    std::vector<ContactMode> modes;  ///< of all contacts
    std::vector<int> closed;         ///< those that are not open
  };
  [[nodiscard]] Modes modes_here() const;
  [[nodiscard]] double fastest(const ContactMoment& moment, const ContactPoint& point,
                               const std::vector<double>& x) const;
  [[nodiscard]] double slowest(const ContactMoment& moment, const ContactPoint& point,
                               const std::vector<double>& x) const;
  [[nodiscard]] bool reaches_a_speed(const ContactMoment& moment, int contact, const ContactPoint& point,
                                     const std::vector<double>& x) const;
  void bound_speeds(const ContactMoment& moment, const std::vector<double>& x);
  [[nodiscard]] std::optional<int> open_with_gap(int function, const Activities& activities) const;
  [[nodiscard]] std::vector<int> without_normal(const ContactMoment& moment, const std::vector<int>& touching,
                                                const std::vector<double>& x) const;
  [[nodiscard]] double no_gap(int contact, const std::vector<double>& x) const;
  [[nodiscard]] static double terms_of(const evaluation::ContactValues::Rows& rows, int row,
                                       const std::vector<int>& states, const std::vector<double>& x);
  [[nodiscard]] double gap_terms(int contact, const std::vector<double>& x) const;
  [[nodiscard]] double pull_on(int contact, const ContactPoint& point, const std::vector<double>& x) const;
  [[nodiscard]] bool rises_by_nothing(const ContactMoment& moment, int contact, const ContactPoint& point,
                                      const std::vector<double>& x) const;
  [[nodiscard]] bool closes_flatly(const ContactMoment& moment, int contact, const ContactPoint& point,
                                   const std::vector<double>& x) const;
  [[nodiscard]] bool is_nothing(const ContactMoment& moment, int contact, double speed, double pull,
                                const std::vector<double>& x) const;
  [[nodiscard]] bool fall_by_nothing(const ContactMoment& moment, const std::vector<int>& touching,
                                     const ContactPoint& point, const std::vector<double>& x);
  [[nodiscard]] bool come_to_rest(const ContactMoment& moment, const std::vector<int>& touching, ContactPoint& point,
                                  std::vector<double>& x);
  void move_ahead(const ContactMoment& moment, double h, std::vector<double>& x) const;
  void note_last_bounces(const ContactMoment& moment, const std::vector<int>& touching, ContactPoint before,
                         const std::vector<double>& x);
  [[nodiscard]] bool comes_to_rest(const ContactMoment& moment, int contact, const ContactPoint& point,
                                   const std::vector<double>& x) const;
  void set_slip(const ContactPoint& point, int contact, const linalg::Vector& velocity, std::vector<double>& x);
  void start_slip(const ContactMoment& moment, int contact, const linalg::Vector& direction, std::vector<double>& x);
  void clean(const ContactMoment& moment, ContactPoint& point, const std::vector<double>& x,
             const std::vector<int>& ended) const;
  [[nodiscard]] std::vector<std::vector<ContactMode>> modes_that_end(const ContactMoment& moment,
                                                                     const ContactPoint& point,
                                                                     const std::vector<int>& ended,
                                                                     const std::vector<double>& x) const;
  [[nodiscard]] std::optional<ContactMode> way_back(const ContactMoment& moment, int contact, bool ends,
                                                    const std::vector<double>& x) const;
  [[nodiscard]] bool touches(int contact, const std::vector<double>& x, const std::vector<int>& ended) const;
  [[nodiscard]] std::optional<std::string> out_of_range(const ContactMoment& moment, const std::vector<int>& touching,
                                                        const ContactPoint& point) const;
  [[nodiscard]] std::optional<linalg::Vector> push(const ContactMoment& moment, const std::vector<int>& touching,
                                                   std::optional<int> pushed, ContactPoint& point,
                                                   std::vector<double>& x);
  void compare_orders(const ContactPoint& before, const std::vector<int>& touching, const linalg::Vector& impulses);
  bool collide(const ContactMoment& moment, const std::vector<int>& touching, std::optional<int> pushed,
               ContactPoint& point, std::vector<double>& x);
  [[nodiscard]] std::optional<std::string> find_modes(const ContactMoment& moment, const std::vector<int>& touching,
                                                      std::vector<std::vector<ContactMode>> excluded,
                                                      ContactPoint& point, std::vector<double>& x);
  void read_ahead(const ContactMoment& moment, const ContactPoint& point, const std::vector<int>& resting,
                  const ContactForces& found, const std::vector<double>& x, ContactPoint& later);
  [[nodiscard]] std::size_t best_ahead(const ContactMoment& moment, const ContactPoint& point,
                                       const std::vector<int>& resting, std::vector<ContactForces>& found,
                                       const std::vector<double>& x);
  void enter(const ContactMoment& moment, const ContactPoint& point, const std::vector<int>& resting,
             const ContactForces& found, std::vector<double>& x);
  void set_units(const ContactMoment& moment, const ContactPoint& point, int i, const std::vector<double>& x,
                 model::Activity& activity) const;
  void enter_slip(const ContactMoment& moment, const ContactPoint& point, const ContactForces& found, int i,
                  bool is_free, std::vector<double>& x);
  [[nodiscard]] const linalg::Vector& least_change(const std::vector<int>& rows, const linalg::Vector& change);
  bool correct_positions(const std::vector<int>& touching, std::vector<double>& x);
  void change_velocities(const std::vector<int>& rows, const linalg::Vector& change, std::vector<double>& x);
  void correct_velocities(Slips slips, std::vector<double>& x);
  void put_at_rest(const ContactPoint& point, const std::vector<int>& resting, std::vector<double>& x);
  void drop_own_roundings(const std::vector<int>& rows, const std::vector<double>& before,
                          std::vector<double>& x) const;
  void keep_slips(std::vector<int>& rows) const;

  evaluation::ModelKernel& kernel_;
  const model::Layout& layout_;
  const std::vector<model::Contact>& contacts_;
  std::vector<int> contact_of_guard_;  ///< by event function, -1: of none; empty without contacts
  std::vector<bool> is_of_contact_;    ///< by jump; empty without contacts
  evaluation::ContactValues values_;
  struct ProjectionStart {
    std::vector<int> held;  ///< rows that the modes hold
    std::vector<double> x;
    linalg::Vector velocity;  ///< of all rows
  };
  struct Projection {
    ProjectionStart start;
    std::vector<int> rows;
    linalg::Vector change, pushes, least;
    linalg::Matrix influence;
    linalg::Ldl factors;
  };
  Projection projection_;  ///< work space: steps allocate nothing
  struct Terms {
    std::vector<double> rate;  ///< without forces
    std::vector<double> magnitude, slope;
  };
  Terms terms_;  ///< likewise
  OpenMotion why_open_;
  linalg::Vector impulses_;
  std::vector<int> last_bounces_;
};

}  // namespace saltus::event_integrator
