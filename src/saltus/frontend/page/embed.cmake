# Script and style of the page of a sweep; elements, colours, address and paper are those of the other pages.
set(saltus_sweep_scripts format.js ticks.js address.js palette.js source.js paper.js)
list(TRANSFORM saltus_sweep_scripts PREPEND src/saltus/report/page/)
set(saltus_sweep_own table.js axes.js picture.js colours.js points.js map.js run_card.js pictures.js sweep.js)
list(TRANSFORM saltus_sweep_own PREPEND src/saltus/frontend/page/)
saltus_embed_text(saltus_frontend sweep_page_script.hpp sweep_page_script ${saltus_sweep_scripts} ${saltus_sweep_own})
saltus_embed_text(saltus_frontend sweep_page_style.hpp sweep_page_style src/saltus/frontend/page/sweep.css)
