--  SPDX-License-Identifier: Apache-2.0
--  Near equality of numbers, vectors and angles.

private package RobotTestingFramework.Near is

   type Numbers is array (Positive range <>) of Long_Float;

   type Comparison (Count, Expected_Count : Natural) is record
      Got       : Numbers (1 .. Count);
      Expected  : Numbers (1 .. Expected_Count);
      Tolerance : Long_Float;
      Angle     : Boolean;
      Scalar    : Boolean;
   end record;

   --  Reports to the host; Holds is whether they are near.
   procedure Report
     (Compared : Comparison;
      What     : String;
      File     : String;
      Line     : Natural;
      Holds    : out Boolean);

end RobotTestingFramework.Near;
