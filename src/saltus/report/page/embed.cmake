# Script and style of the HTML report. The order is the order of definition: page.js starts everything.
set(saltus_report_scripts format.js ticks.js numbers.js address.js series.js palette.js panels.js kinds.js columns.js marks.js branches.js figure.js timeline.js cursor.js chooser.js events.js inspector.js
  surfaces.js phase.js vector_field.js plane.js portrait.js intersection.js cards.js source.js drawing_card.js bodies/bodies.js bodies/scene.js bodies/contact_strip.js
  bodies/player.js bodies/gif.js bodies/animation.js bodies/export_buttons.js bodies/bodies_card.js optimization.js homotopy.js constraints.js open_loop.js overlays.js comparison.js
  order.js multipliers.js sensitivities.js paper.js page.js)
list(TRANSFORM saltus_report_scripts PREPEND src/saltus/report/page/)
saltus_embed_text(saltus_report report_script.hpp report_script ${saltus_report_scripts})
saltus_embed_text(saltus_report report_style.hpp report_style src/saltus/report/page/page.css)
