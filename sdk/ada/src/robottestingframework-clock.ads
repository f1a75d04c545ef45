--  SPDX-License-Identifier: Apache-2.0
--  The time for a plug-in: the simulator's, if its suite has a clock.

private package RobotTestingFramework.Clock is

   --  Whether the time is a simulator's.
   function Is_Simulated return Boolean;

   --  The time since an arbitrary moment.
   function Now return Duration;

   --  Measures the elapsed time, without jumps back.
   type Stopwatch is private;

   function Started return Stopwatch;

   procedure Read (Watch : in out Stopwatch; Passed : out Duration);

private

   type Stopwatch is record
      Is_Known : Boolean  := False;
      Before   : Duration := 0.0;
      Passed   : Duration := 0.0;
   end record;

end RobotTestingFramework.Clock;
