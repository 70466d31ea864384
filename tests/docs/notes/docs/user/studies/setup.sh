plan_only
export MAKEFLAGS="-- WORKERS=0"  # with -n too, make would try the first case of a large study
