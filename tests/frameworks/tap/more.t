#!/usr/bin/perl
# Test::More: plan first, subtests, diagnostics on standard error.
use strict;
use warnings;
use Test::More tests => 9;

ok( 1, 'passes' );
is( 41, 42, 'fails' );                                                # line: fails
is( 'left', 'right', 'fails with "quotes", # and [brackets] ü' );      # line: quotes
is_deeply( { a => 1 }, { a => 2 }, 'structures differ' );             # line: structures
subtest 'moves' => sub {
    plan tests => 3;
    ok( 1, 'joint 1' );
    ok( 0, 'joint 2' );                                               # line: joint 2
    subtest 'deeper' => sub { plan skip_all => 'no gripper'; };
};
TODO: {
    local $TODO = 'not calibrated';
    ok( 0, 'known failure' );
    ok( 1, 'passes by now' );
}
SKIP: { skip 'no arm, <none>', 1; }
print "on stdout\n";
print STDERR "on stderr\n";
ok( 1, 'passes' );
