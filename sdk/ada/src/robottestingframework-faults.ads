--  SPDX-License-Identifier: Apache-2.0
--  Faults that a suite declares without a time, and that its tests inject.

with GNAT.Source_Info;

package RobotTestingFramework.Faults is

   package Source renames GNAT.Source_Info;

   --  Injects a fault, and returns when it has begun. It ends with the test at the latest.
   procedure Inject
     (Name : String; File : String := Source.File; Line : Natural := Source.Line);

   --  Removes a fault. No effect if it has ended already.
   procedure Remove
     (Name : String; File : String := Source.File; Line : Natural := Source.Line);

end RobotTestingFramework.Faults;
