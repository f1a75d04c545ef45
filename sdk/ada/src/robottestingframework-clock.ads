--  SPDX-License-Identifier: Apache-2.0
--  The time that a plug-in follows: the simulator's, if its suite has a clock.

private package RobotTestingFramework.Clock is

   --  Whether the time is a simulator's.
   function Is_Simulated return Boolean;

   --  The time since a moment that does not matter.
   function Now return Duration;

   --  Measures how far the time goes on. What it jumps back is no time.
   type Stopwatch is private;

   function Started return Stopwatch;

   procedure Look (Watch : in out Stopwatch; Passed : out Duration);

private

   type Stopwatch is record
      Is_Known : Boolean  := False;
      Before   : Duration := 0.0;
      Passed   : Duration := 0.0;
   end record;

end RobotTestingFramework.Clock;
