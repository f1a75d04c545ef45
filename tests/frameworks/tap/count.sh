#!/bin/sh
# Counts the results of a program with Perl's TAP::Parser: `count.sh PROGRAM`. It cannot read
# all YAML blocks of others.
"$@" 2>/dev/null | sed '/^ *---$/,/^ *[.][.][.]$/d' | perl -MTAP::Parser -e '
  local $/;
  my $parser = TAP::Parser->new({ tap => scalar <STDIN> });
  my %count = (passed => 0, failed => 0, skipped => 0);
  while (my $result = $parser->next) {
    next unless $result->is_test;
    my $is_expected = $result->has_todo && !$result->is_actual_ok;
    $count{ $result->has_skip || $is_expected ? "skipped" : $result->is_ok ? "passed" : "failed" }++;
  }
  printf qq({"passed":%d,"failed":%d,"skipped":%d}\n), @count{qw(passed failed skipped)};
'
